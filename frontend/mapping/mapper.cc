#include "frontend/mapping/mapper.h"

#include <utility>

#include "core/util/input_error.h"
#include "core/util/stage_timer.h"
#include "frontend/places/relocaliser.h"

namespace rgbd_pose {
namespace {

// Views are compared by pixels so far apart: 192 of 640 x 480.
constexpr int kSampleStepPx = 40;

// How near a view must be to one that it makes redundant.
constexpr double kRedundantFlowPx = 30.0;

bool IsSame(const KeyframePlace& a, const KeyframePlace& b) {
  return a.segment == b.segment &&
         a.map_from_cam.rotation.coeffs() == b.map_from_cam.rotation.coeffs() &&
         a.map_from_cam.translation == b.map_from_cam.translation;
}

}  // namespace

Mapper::Mapper(const MappingOptions& options, std::unique_ptr<Tracker> tracker)
    : options_(options),
      tracker_(std::move(tracker)),
      graph_(options.window, options.drift),
      pairing_(options_, keyframes_, index_, &tracker_, &graph_) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("mapping: " + error);
}

Mapper::~Mapper() = default;

int Mapper::AddKeyframe(int id, const Frame& frame, const Rigid3d& map_from_cam,
                        int segment, bool is_held) {
  const FrontendOptions& images = tracker_.images();
  const int at = graph_.Add(map_from_cam, segment, is_held);
  MappedKeyframe keyframe;
  keyframe.id = id;
  keyframe.images = StoredImages(frame);
  keyframe.samples = ViewOverlap(frame, images.camera, kSampleStepPx,
                                 images.min_depth, images.max_depth);
  if (options_.max_loop_candidates > 0) {
    keyframe.features =
        DescribeKeyframe(frame, images.camera, images.DepthLookup());
  }
  keyframes_.push_back(std::move(keyframe));
  numbers_[id] = at;
  return at;
}

void Mapper::Load(const KeyframeMap& map, bool is_held) {
  for (const std::string& error :
       {map.Check(), map.CheckCamera(tracker_.images().camera)}) {
    if (!error.empty()) throw InputError("map: " + error);
  }
  for (const MapKeyframe& keyframe : map.keyframes) {
    const int at =
        AddKeyframe(keyframe.id, keyframe.images.Restore(),
                    keyframe.map_from_cam, keyframe.segment, is_held);
    index_.Add(at, keyframes_[at].features.described.descriptors);
  }
  for (const RelativePose& edge : map.edges) {
    RelativePose numbered = edge;
    numbered.ref = numbers_.at(edge.ref);
    numbered.cur = numbers_.at(edge.cur);
    graph_.AddPair(numbered, /*is_tracked=*/false);
  }
}

MapUpdate Mapper::Add(NewKeyframe added) {
  MapUpdate update;
  const StageTimer timer(&update.ms);
  std::vector<RelativePose> edges;
  for (RelativePose edge : added.edges) {
    const auto ref = numbers_.find(edge.ref);
    if (ref == numbers_.end()) continue;
    edge.ref = ref->second;
    edges.push_back(graph_.Reanchor(edge));
  }
  if (!edges.empty()) {
    added.segment = graph_.segment(edges[0].ref);
    added.map_from_cam =
        graph_.pose(edges[0].ref) * edges[0].cur_from_ref.Inverse();
  }
  const int newest = AddKeyframe(added.id, added.frame, added.map_from_cam,
                                 added.segment, /*is_held=*/false);
  for (RelativePose& edge : edges) {
    edge.cur = newest;
    if (graph_.segment(edge.ref) != graph_.segment(newest)) {
      if (!graph_.Join(edge)) continue;
      ++update.joined;
    }
    graph_.AddPair(edge, /*is_tracked=*/true);
  }
  const PreparedFrame prepared(added.frame);
  pairing_.PairByPose(newest, prepared, &update);
  pairing_.CloseLoopsByAppearance(newest, prepared, &update);
  if (update.joined > 0) pairing_.PairByPose(newest, prepared, &update);
  index_.Add(newest, keyframes_[newest].features.described.descriptors);

  update.error =
      update.loops > 0 ? graph_.SolveAll() : graph_.SolveNear(newest);
  FindReturn(newest, &update);
  CullKeyframes(newest);
  PublishMovedPoses(&update);
  return update;
}

std::optional<FoundKeyframe> Mapper::Find(const Frame& lost) {
  const FrontendOptions& images = tracker_.images();
  const Relocaliser relocaliser(images.camera, images.DepthLookup());
  const auto found = relocaliser.FindInMap(
      lost, index_, [this](int at) -> const PlaceFeatures& {
        return keyframes_[at].features;
      });
  if (!found.has_value()) return std::nullopt;
  const MappedKeyframe& keyframe = keyframes_[found->place_id];
  return FoundKeyframe{keyframe.id, keyframe.images.Restore()};
}

// The one whose view is nearest, but for those that the odometry has itself.
void Mapper::FindReturn(int newest, MapUpdate* update) const {
  double least = 2.0 * kRedundantFlowPx;
  int nearest = -1;
  for (int at = 0; at + options_.window < newest; ++at) {
    if (graph_.IsRemoved(at) || graph_.segment(at) != graph_.segment(newest)) {
      continue;
    }
    const Overlap overlap = keyframes_[at].samples.SeenFrom(
        graph_.pose(newest).Inverse() * graph_.pose(at));
    if (overlap.share < options_.redundant_share || overlap.flow_px >= least) {
      continue;
    }
    least = overlap.flow_px;
    nearest = at;
  }
  if (nearest < 0) return;
  const MappedKeyframe& keyframe = keyframes_[nearest];
  update->returned_to = FoundKeyframe{keyframe.id, keyframe.images.Restore()};
}

// Looks at the keyframe that leaves the window.
void Mapper::CullKeyframes(int newest) {
  const int at = newest - options_.window;
  if (at < 0 || graph_.IsRemoved(at) || !graph_.IsRedundant(at)) return;
  for (const int neighbor : graph_.links().Neighbors(at)) {
    if (neighbor > at) continue;
    const Overlap overlap = keyframes_[at].samples.SeenFrom(
        graph_.pose(neighbor).Inverse() * graph_.pose(at));
    if (overlap.share < options_.redundant_share ||
        overlap.flow_px > kRedundantFlowPx) {
      continue;
    }
    graph_.Remove(at, neighbor);
    index_.Remove(at);
    tracker_.Forget(at);
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

void Mapper::PublishMovedPoses(MapUpdate* update) {
  for (int at = 0; at < graph_.size(); ++at) {
    MappedKeyframe& keyframe = keyframes_[at];
    const KeyframePlace place = {graph_.pose(at), graph_.segment(at)};
    if (keyframe.published.has_value() && IsSame(*keyframe.published, place))
      continue;
    keyframe.published = place;
    update->moved[keyframe.id] = place;
  }
}

KeyframeMap Mapper::Map(bool as_solved) const {
  KeyframeMap map;
  map.camera = tracker_.images().camera;
  for (int at = 0; at < graph_.size(); ++at) {
    if (graph_.IsRemoved(at)) continue;
    map.keyframes.push_back({keyframes_[at].id, graph_.segment(at),
                             graph_.pose(at), keyframes_[at].images});
  }
  for (const KeyframePair& pair : graph_.pairs()) {
    RelativePose edge = pair.edge;
    edge.ref = keyframes_[pair.edge.ref].id;
    edge.cur = keyframes_[pair.edge.cur].id;
    if (as_solved) edge.covariance = graph_.CovarianceAsSolved(pair);
    map.edges.push_back(edge);
  }
  return map;
}

std::vector<MotionMatrix> Mapper::Covariances() const {
  const std::vector<MotionMatrix> all = graph_.Covariances();
  std::vector<MotionMatrix> kept;
  for (int at = 0; at < static_cast<int>(all.size()); ++at) {
    if (!graph_.IsRemoved(at)) kept.push_back(all[at]);
  }
  return kept;
}

}  // namespace rgbd_pose
