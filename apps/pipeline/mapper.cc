#include "apps/pipeline/mapper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/stage_timer.h"
#include "frontend/places/relocaliser.h"

namespace rgbd_pose {
namespace {

// References kept made, some 3 MB each.
constexpr size_t kMaxReferences = 24;

// Views are compared by pixels so far apart: 192 of 640 x 480.
constexpr int kSampleStepPx = 40;

// How much less like the best a keyframe may look and still be asked.
constexpr double kMinScoreShare = 0.5;

// Two pairs between the same segments agree within this.
constexpr double kMeetingRotation = 0.05;    // rad
constexpr double kMeetingTranslation = 0.1;  // m

bool IsWithin(const Rigid3d& a, const Rigid3d& b, double rotation,
              double translation) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() <= rotation && moved.translation.norm() <= translation;
}

}  // namespace

std::string MappingOptions::Check() const {
  if (max_pairs < 1) return "max_pairs must be at least 1";
  if (!(min_pair_share > 0.0 && min_pair_share <= 1.0)) {
    return "min_pair_share must be above 0 and at most 1";
  }
  if (!(max_pair_zoom >= 1.0)) return "max_pair_zoom must be at least 1";
  if (loop_hops < 1) return "loop_hops must be at least 1";
  if (max_lookalikes < 0) return "max_lookalikes must not be negative";
  if (!(max_pair_rotation > 0.0) || !(max_pair_translation > 0.0)) {
    return "what a pair may differ by must be positive";
  }
  if (!(min_seen_share >= 0.0) || !(max_pair_sigma > 0.0)) {
    return "min_seen_share must not be negative, max_pair_sigma be positive";
  }
  if (!(min_lookalike_inliers >= 0.0 && min_lookalike_inliers <= 1.0)) {
    return "min_lookalike_inliers must lie between 0 and 1";
  }
  if (!(redundant_share > 0.0) || !(redundant_flow_px >= 0.0)) {
    return "redundant_share must be positive, redundant_flow_px not negative";
  }
  return graph.Check();
}

Mapper::Mapper(const MappingOptions& options, std::unique_ptr<Tracker> tracker)
    : options_(options),
      tracker_(std::move(tracker)),
      graph_(options.graph),
      tracked_(tracker_->images().camera) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("mapping: " + error);
}

Mapper::~Mapper() = default;

int Mapper::AddKeyframe(int id, const Frame& frame, const Rigid3d& map_from_cam,
                        int segment, bool is_held) {
  const FrontendOptions& images = tracker_->images();
  const int at = graph_.Add(map_from_cam, segment, is_held);
  Keyframe keyframe;
  keyframe.id = id;
  keyframe.images = StoredImages(frame);
  keyframe.samples = ViewSamples(frame, images.camera, kSampleStepPx,
                                 images.min_depth, images.max_depth);
  if (options_.max_lookalikes > 0) {
    keyframe.features =
        DescribeKeyframe(frame, images.camera, images.DepthLookup());
  }
  keyframes_.push_back(std::move(keyframe));
  numbers_[id] = at;
  return at;
}

void Mapper::Load(const KeyframeMap& map, bool is_held) {
  for (const std::string& error :
       {map.Check(), map.CheckCamera(tracker_->images().camera)}) {
    if (!error.empty()) throw InputError("map: " + error);
  }
  for (const MapKeyframe& keyframe : map.keyframes) {
    const int at =
        AddKeyframe(keyframe.id, keyframe.images.Restore(),
                    keyframe.map_from_cam, keyframe.segment, is_held);
    index_.Add(at, keyframes_[at].features.described.descriptors);
  }
  for (const Edge& edge : map.edges) {
    Edge numbered = edge;
    numbered.ref = numbers_.at(edge.ref);
    numbered.cur = numbers_.at(edge.cur);
    graph_.AddPair(numbered, /*is_tracked=*/false);
  }
}

const Reference* Mapper::ReferenceOf(int at) {
  const auto made =
      std::find_if(references_.begin(), references_.end(),
                   [=](const auto& entry) { return entry.first == at; });
  if (made != references_.end()) {
    references_.splice(references_.begin(), references_, made);
    return references_.front().second.get();
  }
  const auto prepared = tracker_->Prepare(keyframes_[at].images.Restore());
  std::string why_not;
  auto reference =
      tracker_->MakeReference(*prepared, nullptr, nullptr, &why_not);
  if (reference == nullptr) return nullptr;
  if (references_.size() == kMaxReferences) references_.pop_back();
  references_.emplace_front(at, std::move(reference));
  return references_.front().second.get();
}

double Mapper::SharedView(int ref, int cur, const Rigid3d& cur_from_ref) const {
  const Overlap there = keyframes_[ref].samples.SeenFrom(cur_from_ref);
  if (there.share < options_.min_pair_share) return 0.0;
  const Overlap back = keyframes_[cur].samples.SeenFrom(cur_from_ref.Inverse());
  if (std::max(there.zoom, back.zoom) > options_.max_pair_zoom) return 0.0;
  return std::min(there.share, back.share);
}

std::vector<int> Mapper::SeeingTheSame(int newest) const {
  std::vector<std::pair<double, int>> seen;
  for (int at = 0; at < newest; ++at) {
    if (graph_.IsDropped(at) || graph_.segment(at) != graph_.segment(newest) ||
        graph_.links().AreJoined(at, newest)) {
      continue;
    }
    const Rigid3d cur_from_ref =
        graph_.pose(newest).Inverse() * graph_.pose(at);
    const double share = SharedView(at, newest, cur_from_ref);
    if (share >= options_.min_pair_share) seen.emplace_back(-share, at);
  }
  std::sort(seen.begin(), seen.end());
  const size_t most = options_.max_pairs;
  if (seen.size() > most) {
    const auto rest = seen.begin() + (most + 1) / 2;
    std::sort(rest, seen.end(),
              [](const auto& a, const auto& b) { return a.second < b.second; });
    seen.resize(most);
  }
  std::vector<int> result;
  for (const auto& [share, at] : seen) result.push_back(at);
  return result;
}

std::optional<Edge> Mapper::MakePair(int ref, int cur,
                                     const PreparedFrame& frame,
                                     const Rigid3d& cur_from_ref_guess,
                                     double min_inlier_share) {
  const Reference* reference = ReferenceOf(ref);
  if (reference == nullptr) return std::nullopt;
  tracker_->Track(*reference, frame, cur_from_ref_guess, nullptr, &tracked_);
  const MotionEstimate& estimate = tracked_.estimate;
  if (tracked_.status != TrackingStatus::kOk || !estimate.ok() ||
      estimate.num_inliers < min_inlier_share * estimate.num_used ||
      estimate.sigma > options_.max_pair_sigma ||
      tracked_.overlap.share < options_.min_seen_share ||
      !IsWithin(estimate.cur_from_prev, cur_from_ref_guess,
                options_.max_pair_rotation, options_.max_pair_translation)) {
    return std::nullopt;
  }
  return Edge{ref, cur, estimate.cur_from_prev, estimate.covariance};
}

void Mapper::PairByPose(int newest, const PreparedFrame& frame,
                        MapUpdate* update) {
  for (const int at : SeeingTheSame(newest)) {
    const bool is_loop =
        graph_.links().Hops(newest, at, options_.loop_hops + 1) >
        options_.loop_hops;
    const auto edge =
        MakePair(at, newest, frame,
                 graph_.pose(newest).Inverse() * graph_.pose(at), 0.0);
    if (!edge.has_value()) continue;
    graph_.AddPair(*edge, /*is_tracked=*/false, is_loop);
    ++update->pairs;
    update->loops += is_loop;
  }
}

// What looks alike is believed where the way there by other pairs allows it,
// or, if there is none, where more than one pair tells the same.
void Mapper::PairByLooks(int newest, const PreparedFrame& frame,
                         MapUpdate* update) {
  if (options_.max_lookalikes == 0) return;
  const PlaceFeatures& cur = keyframes_[newest].features;
  const std::vector<bool> is_near =
      graph_.links().Within(newest, options_.loop_hops);
  const auto may_be = [&](int at) { return !is_near[at]; };
  const std::vector<PlaceCandidate> alike =
      index_.Query(cur.described.descriptors, options_.max_lookalikes, may_be);
  for (const PlaceCandidate& candidate : alike) {
    if (candidate.score < kMinScoreShare * alike.front().score) break;
    const int at = candidate.keyframe;
    const auto rough = FindRoughMotion(
        MatchPlaces(keyframes_[at].features, cur, tracker_->images().camera));
    if (!rough.has_value()) continue;
    const auto edge = MakePair(at, newest, frame, rough->cur_from_prev,
                               options_.min_lookalike_inliers);
    if (!edge.has_value() ||
        SharedView(at, newest, edge->cur_from_ref) == 0.0) {
      continue;
    }
    if (graph_.segment(at) != graph_.segment(newest)) {
      if (!AgreesWithOthers(*edge, frame) && !HaveMetBefore(*edge)) continue;
      graph_.Join(*edge);
      ++update->joined;
    } else if (!graph_.IsPlausible(*edge)) {
      continue;
    }
    graph_.AddPair(*edge, /*is_tracked=*/false, /*is_loop=*/true);
    ++update->pairs;
    ++update->loops;
  }
}

// Whether a keyframe beside edge.ref, as its segment has it, makes a pair that
// tells the same.
bool Mapper::AgreesWithOthers(const Edge& edge, const PreparedFrame& frame) {
  const std::vector<int> beside = graph_.links().Beside(edge.ref);
  for (const int at : beside) {
    const Rigid3d guess =
        edge.cur_from_ref * graph_.pose(edge.ref).Inverse() * graph_.pose(at);
    if (SharedView(at, edge.cur, guess) < options_.min_pair_share) continue;
    const auto other =
        MakePair(at, edge.cur, frame, guess, options_.min_lookalike_inliers);
    if (other.has_value() && IsWithin(other->cur_from_ref, guess,
                                      kMeetingRotation, kMeetingTranslation)) {
      return true;
    }
  }
  return false;
}

// Whether an earlier keyframe of the segment said the same.
bool Mapper::HaveMetBefore(const Edge& edge) {
  const Meeting meeting = {graph_.segment(edge.ref), graph_.segment(edge.cur),
                           graph_.pose(edge.ref) * edge.cur_from_ref.Inverse() *
                               graph_.pose(edge.cur).Inverse()};
  for (const Meeting& earlier : meetings_) {
    if (earlier.ref_segment == meeting.ref_segment &&
        earlier.cur_segment == meeting.cur_segment &&
        IsWithin(earlier.ref_from_cur, meeting.ref_from_cur, kMeetingRotation,
                 kMeetingTranslation)) {
      return true;
    }
  }
  meetings_.push_back(meeting);
  return false;
}

MapUpdate Mapper::Add(NewKeyframe added) {
  MapUpdate update;
  const StageTimer timer(&update.ms);
  std::vector<Edge> edges;
  for (Edge edge : added.edges) {
    const auto ref = numbers_.find(edge.ref);
    if (ref == numbers_.end()) continue;
    edge.ref = ref->second;
    edges.push_back(graph_.Anchored(edge));
  }
  if (!edges.empty()) {
    added.segment = graph_.segment(edges[0].ref);
    added.map_from_cam =
        graph_.pose(edges[0].ref) * edges[0].cur_from_ref.Inverse();
  }
  const int newest = AddKeyframe(added.id, added.frame, added.map_from_cam,
                                 added.segment, /*is_held=*/false);
  for (Edge& edge : edges) {
    edge.cur = newest;
    graph_.AddPair(edge, /*is_tracked=*/true);
  }
  const auto prepared = tracker_->Prepare(added.frame);
  PairByPose(newest, *prepared, &update);
  PairByLooks(newest, *prepared, &update);
  if (update.joined > 0) PairByPose(newest, *prepared, &update);
  index_.Add(newest, keyframes_[newest].features.described.descriptors);

  update.trouble =
      update.loops > 0 ? graph_.SolveAll() : graph_.SolveNear(newest);
  FindReturn(newest, &update);
  MakeWay(newest);
  Fill(&update);
  return update;
}

std::optional<FoundKeyframe> Mapper::Find(const Frame& lost) {
  const FrontendOptions& images = tracker_->images();
  const Relocaliser relocaliser(images.camera, images.DepthLookup());
  const auto found = relocaliser.FindInMap(
      lost, index_, [this](int at) -> const PlaceFeatures& {
        return keyframes_[at].features;
      });
  if (!found.has_value()) return std::nullopt;
  const Keyframe& keyframe = keyframes_[found->place_id];
  return FoundKeyframe{keyframe.id, keyframe.images.Restore()};
}

// The one whose view is nearest, but for those that the odometry has itself.
void Mapper::FindReturn(int newest, MapUpdate* update) const {
  double least = 2.0 * options_.redundant_flow_px;
  int nearest = -1;
  for (int at = 0; at + options_.graph.window < newest; ++at) {
    if (graph_.IsDropped(at) || graph_.segment(at) != graph_.segment(newest)) {
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
  const Keyframe& keyframe = keyframes_[nearest];
  update->returned_to = FoundKeyframe{keyframe.id, keyframe.images.Restore()};
}

// Looks at the keyframe that leaves the window.
void Mapper::MakeWay(int newest) {
  const int at = newest - options_.graph.window;
  if (at < 0 || graph_.IsDropped(at) || !graph_.CanDoWithout(at)) return;
  for (const int beside : graph_.links().Beside(at)) {
    if (beside > at) continue;
    const Overlap overlap = keyframes_[at].samples.SeenFrom(
        graph_.pose(beside).Inverse() * graph_.pose(at));
    if (overlap.share < options_.redundant_share ||
        overlap.flow_px > options_.redundant_flow_px) {
      continue;
    }
    graph_.Drop(at, beside);
    index_.Remove(at);
    references_.remove_if([=](const auto& entry) { return entry.first == at; });
    Keyframe gone;
    gone.id = keyframes_[at].id;
    keyframes_[at] = std::move(gone);
    return;
  }
}

MapUpdate Mapper::Finish() {
  MapUpdate update;
  const StageTimer timer(&update.ms);
  if (graph_.size() > 0) update.trouble = graph_.SolveAll();
  Fill(&update);
  return update;
}

void Mapper::Fill(MapUpdate* update) const {
  for (int at = 0; at < graph_.size(); ++at) {
    update->map_from_keyframe[keyframes_[at].id] = graph_.pose(at);
    update->segments[keyframes_[at].id] = graph_.segment(at);
  }
}

KeyframeMap Mapper::Map(bool as_solved) const {
  KeyframeMap map;
  map.camera = tracker_->images().camera;
  for (int at = 0; at < graph_.size(); ++at) {
    if (graph_.IsDropped(at)) continue;
    map.keyframes.push_back({keyframes_[at].id, graph_.segment(at),
                             graph_.pose(at), keyframes_[at].images});
  }
  for (const KeyframePair& pair : graph_.pairs()) {
    Edge edge = pair.edge;
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
    if (!graph_.IsDropped(at)) kept.push_back(all[at]);
  }
  return kept;
}

}  // namespace rgbd_pose
