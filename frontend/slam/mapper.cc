#include "frontend/slam/mapper.h"

#include "core/util/input_error.h"
#include "core/util/stage_timer.h"
#include "frontend/places/relocaliser.h"

namespace rgbd_pose {
namespace {

// Distance of the pixels used to compare views: 192 pixels of 640 x 480.
constexpr int kSampleStepPx = 40;

// Maximum flow between a redundant view and the view that replaces it.
constexpr double kRedundantFlowPx = 30.0;

// A covariance of [omega C] with each of them in other axes.
MotionMatrix InAxes(const Eigen::Quaterniond& of_omega,
                    const Eigen::Quaterniond& of_C,
                    const MotionMatrix& covariance) {
  MotionMatrix turned = MotionMatrix::Zero();
  turned.topLeftCorner<3, 3>() = of_omega.toRotationMatrix();
  turned.bottomRightCorner<3, 3>() = of_C.toRotationMatrix();
  return turned * covariance * turned.transpose();
}

}  // namespace

std::string MappingOptions::Check() const {
  if (max_pairs < 1) return "max_pairs must be at least 1";
  if (!(min_pair_share > 0.0 && min_pair_share <= 1.0)) {
    return "min_pair_share must be above 0 and at most 1";
  }
  if (max_loop_candidates < 0)
    return "max_loop_candidates must not be negative";
  if (!(redundant_share > 0.0)) return "redundant_share must be positive";
  if (window < 1) return "graph: window must be at least 1";
  if (!(drift > 0.0)) return "graph: drift must be positive";
  return "";
}

Mapper::Mapper(const MappingOptions& options, std::unique_ptr<Tracker> tracker)
    : options_(options),
      graph_(options.window, options.drift),
      tracker_(std::move(tracker)),
      tracked_(tracker_->images().camera),
      rectifier_(tracker_->images().camera) {
  RequireSound(options.Check(), "mapping: ");
}

int Mapper::AddKeyframe(Keyframe keyframe, const PreparedFrame& frame,
                        bool is_held) {
  const FrontendOptions& images = tracker_->images();
  const int at = graph_.Add(keyframe.world_from_cam, keyframe.segment, is_held);
  numbers_[keyframe.id] = at;
  keyframe.frame = PreparedFrame();
  if (keyframe.images.gray == nullptr) keyframe.images = StoredImages(frame);
  if (keyframe.features == nullptr && options_.max_loop_candidates > 0) {
    keyframe.features =
        std::make_shared<const PlaceFeatures>(DescribeKeyframe(frame, images));
  }
  keyframes_.push_back(
      {std::move(keyframe), std::nullopt,
       ViewOverlap(frame, images.camera, kSampleStepPx, images.depth.min_depth,
                   images.depth.max_depth)});
  return at;
}

void Mapper::Index(int at) {
  if (options_.max_loop_candidates == 0) return;
  index_.Add(at, keyframes_[at].features->described.descriptors);
}

MapEdge Mapper::ById(MapEdge numbered) const {
  numbered.ref = keyframes_[numbered.ref].id;
  numbered.cur = keyframes_[numbered.cur].id;
  return numbered;
}

void Mapper::Load(const KeyframeMap& map, bool is_held) {
  RequireSound(map.Check(), "map: ");
  const std::string difference = map.CheckCamera(tracker_->images().camera);
  if (!difference.empty()) {
    throw InputError("map: " + difference +
                     "; give the camera that made the map, or make a new one");
  }
  // If an image is damaged, nothing of the map is loaded.
  for (const Keyframe& keyframe : map.keyframes) keyframe.Unpacked();
  for (const Keyframe& keyframe : map.keyframes) {
    Index(AddKeyframe(keyframe, keyframe.Unpacked(), is_held));
  }
  for (const MapEdge& edge : map.edges) {
    RelativePose numbered = edge;
    numbered.ref = numbers_.at(edge.ref);
    numbered.cur = numbers_.at(edge.cur);
    graph_.AddPair(numbered, edge.is_tracked);
  }
  for (const MapUp& up : map.ups) SetUp(up);
}

MapUpdate Mapper::Add(Keyframe added,
                      const std::vector<RelativePose>& tracked) {
  MapUpdate update;
  const StageTimer timer(&update.ms);
  const size_t known_pairs = graph_.pairs().size();
  std::vector<RelativePose> edges;
  for (RelativePose edge : tracked) {
    const auto ref = numbers_.find(edge.ref);
    if (ref == numbers_.end()) continue;
    edge.ref = ref->second;
    edges.push_back(graph_.Reanchor(edge));
  }
  if (!edges.empty()) {
    added.segment = graph_.segment(edges[0].ref);
    added.world_from_cam =
        graph_.pose(edges[0].ref) * edges[0].cur_from_ref.Inverse();
  }
  if (!added.frame.Timing().IsOneMoment()) {
    added.frame = PreparedFrame(
        rectifier_.Rectify(added.frame, added.reference_from_stamp));
    added.reference_from_stamp = Rigid3d();
    added.features.reset();
  }
  added.frame.depth_delay = 0.0;  // the images are of one moment now
  const PreparedFrame frame = added.Unpacked();
  const int newest = AddKeyframe(std::move(added), frame, /*is_held=*/false);
  for (RelativePose& edge : edges) {
    edge.cur = newest;
    if (graph_.segment(edge.ref) != graph_.segment(newest)) {
      if (!graph_.Join(edge)) continue;
      ++update.joined;
    }
    graph_.AddPair(edge, /*is_tracked=*/true);
  }
  PairByPose(newest, frame);
  update.joined += CloseLoopsByAppearance(newest, frame);
  if (update.joined > 0) PairByPose(newest, frame);
  Index(newest);
  for (size_t i = known_pairs; i < graph_.pairs().size(); ++i) {
    const MapEdge& pair = graph_.pairs()[i];
    update.links.push_back(ById(pair));
    update.pairs += !pair.is_tracked;
    update.loops += pair.is_loop;
  }

  update.error =
      update.loops > 0 ? graph_.SolveAll() : graph_.SolveNear(newest);
  FindReturn(newest, &update);
  CullKeyframes(newest);
  PublishMovedPoses(&update);
  return update;
}

Keyframe Mapper::WithImages(int at) const {
  Keyframe keyframe = keyframes_[at];
  keyframe.frame = keyframe.Unpacked();
  return keyframe;
}

std::optional<Keyframe> Mapper::Find(const PreparedFrame& lost) {
  const Relocaliser relocaliser(tracker_->images());
  const auto found = relocaliser.FindInMap(
      lost, index_, [this](int at) -> const PlaceFeatures& {
        return *keyframes_[at].features;
      });
  if (!found.has_value()) return std::nullopt;
  return WithImages(found->keyframe);
}

// Finds the keyframe with the nearest view among those that the odometry does
// not have.
void Mapper::FindReturn(int newest, MapUpdate* update) const {
  double least = 2.0 * kRedundantFlowPx;
  int nearest = -1;
  for (int at = 0; at + options_.window < newest; ++at) {
    if (graph_.IsRemoved(at) || graph_.segment(at) != graph_.segment(newest)) {
      continue;
    }
    const Overlap overlap =
        keyframes_[at].samples.SeenFrom(graph_.CurFromRef(at, newest));
    if (overlap.share < options_.redundant_share || overlap.flow_px >= least) {
      continue;
    }
    least = overlap.flow_px;
    nearest = at;
  }
  if (nearest >= 0) update->returned_to = WithImages(nearest);
}

// Removes the keyframe that leaves the window if it is redundant.
void Mapper::CullKeyframes(int newest) {
  const int at = newest - options_.window;
  if (at < 0 || graph_.IsRemoved(at) || !graph_.IsRedundant(at)) return;
  for (const int neighbor : graph_.links().Neighbors(at)) {
    if (neighbor > at) continue;
    const Overlap overlap =
        keyframes_[at].samples.SeenFrom(graph_.CurFromRef(at, neighbor));
    if (overlap.share < options_.redundant_share ||
        overlap.flow_px > kRedundantFlowPx) {
      continue;
    }
    graph_.Remove(at, neighbor);
    index_.Remove(at);
    references_.remove_if([=](const auto& r) { return r.first == at; });
    MappedKeyframe gone;
    gone.id = keyframes_[at].id;
    gone.published = keyframes_[at].published;
    keyframes_[at] = std::move(gone);
    return;
  }
}

MapUpdate Mapper::Finish() {
  MapUpdate update;
  const StageTimer timer(&update.ms);
  if (graph_.size() > 0) update.error = graph_.SolveAll();
  PublishMovedPoses(&update);
  return update;
}

MapUpdate Mapper::MoveAll(const Rigid3d& moved_from_map) {
  MapUpdate update;
  graph_.MoveAll(moved_from_map);
  PublishMovedPoses(&update);
  return update;
}

void Mapper::PublishMovedPoses(MapUpdate* update) {
  for (int at = 0; at < graph_.size(); ++at) {
    MappedKeyframe& keyframe = keyframes_[at];
    const KeyframePlace place = {graph_.pose(at), graph_.segment(at)};
    if (keyframe.published.has_value() &&
        keyframe.published->segment == place.segment &&
        keyframe.published->map_from_cam == place.map_from_cam) {
      continue;
    }
    keyframe.published = place;
    update->moved[keyframe.id] = place;
  }
}

std::vector<MotionMatrix> Mapper::Covariances() const {
  std::vector<MotionMatrix> covariances = graph_.Covariances();
  if (covariances.empty()) return covariances;
  auto covariance = covariances.begin();
  for (int at = 0; at < graph_.size(); ++at) {
    if (graph_.IsRemoved(at)) continue;
    if (!graph_.IsFixed(at)) {
      // The error of its own timing moves it along its own axes.
      *covariance +=
          InAxes(Eigen::Quaterniond::Identity(), graph_.pose(at).rotation,
                 keyframes_[at].timing_covariance);
      const int first = graph_.FirstOf(at);
      if (!graph_.IsHeld(first)) {
        // An error of the first keyframe turns and moves all others, about
        // where it is.
        const Rigid3d& start = graph_.pose(first);
        const Rigid3d map_from_start(Eigen::Quaterniond::Identity(),
                                     start.translation);
        *covariance = ComposedCovariance(
            graph_.pose(at).Inverse() * map_from_start, *covariance, Rigid3d(),
            InAxes(start.rotation, start.rotation,
                   keyframes_[first].timing_covariance));
      }
    }
    ++covariance;
  }
  return covariances;
}

KeyframeMap Mapper::Map(bool as_solved) const {
  KeyframeMap map;
  map.camera = tracker_->images().camera;
  for (int at = 0; at < graph_.size(); ++at) {
    if (graph_.IsRemoved(at)) continue;
    map.keyframes.push_back(keyframes_[at]);
    map.keyframes.back().segment = graph_.segment(at);
    map.keyframes.back().world_from_cam = graph_.pose(at);
    if (const auto& up = graph_.up(at); up.has_value()) {
      map.ups.push_back({keyframes_[at].id, up->in_cam, up->sigma});
    }
  }
  for (const MapEdge& pair : graph_.pairs()) {
    MapEdge edge = ById(pair);
    if (as_solved) edge.covariance = graph_.CovarianceAsSolved(pair);
    map.edges.push_back(edge);
  }
  return map;
}

}  // namespace rgbd_pose
