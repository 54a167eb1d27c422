#include "frontend/slam/slam.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/stage_timer.h"

namespace rgbd_pose {
namespace {

// What has to be added to a number of a map's keyframes so that none is below
// `first`, as all others are.
int OffsetOf(const KeyframeMap& map, int Keyframe::*number, int first) {
  constexpr int64_t kMost = 1000000000;
  int64_t least = 0, most = 0;
  for (const Keyframe& keyframe : map.keyframes) {
    least = std::min<int64_t>(least, keyframe.*number);
    most = std::max<int64_t>(most, keyframe.*number);
  }
  if (first + most - least > kMost) {
    throw InputError(
        "map: the ids or segments of its keyframes, with those of maps loaded "
        "before, go beyond 1,000,000,000; number them from 0");
  }
  return static_cast<int>(first - least);
}

}  // namespace

Slam::Slam(const OdometrySettings& odometry, const SlamSettings& settings,
           const RgbdCamera& camera)
    : settings_(settings),
      odometry_(MakeOdometry(odometry, camera)),
      mapper_(settings.mapping, MakeTracker(odometry, camera)) {
  if (settings.update_delay < 0 || settings.update_delay > 1000000) {
    throw InputError("slam: update_delay must be 0 to 1000000");
  }
}

void Slam::Load(KeyframeMap map, bool is_held) {
  RequireSound(map.Check(), "map: ");
  // A map that was loaded before may have the same ids.
  const int id = OffsetOf(map, &Keyframe::id, first_id_);
  const int segment = OffsetOf(map, &Keyframe::segment, first_segment_);
  for (Keyframe& keyframe : map.keyframes) {
    keyframe.id += id;
    keyframe.segment += segment;
  }
  for (RelativePose& edge : map.edges) {
    edge.ref += id;
    edge.cur += id;
  }
  for (MapUp& up : map.ups) up.keyframe += id;
  mapper_.Load(map, is_held);
  links_.insert(links_.end(), map.edges.begin(), map.edges.end());
  for (const Keyframe& keyframe : map.keyframes) {
    // In the odometry, ids of loaded keyframes stay below -1.
    first_id_ = std::max(first_id_, keyframe.id + 2);
    first_segment_ = std::max(first_segment_, keyframe.segment + 1);
    map_from_keyframe_[keyframe.id] = keyframe.world_from_cam;
    segments_[keyframe.id] = keyframe.segment;
  }
}

SlamFrame Slam::Track(const Frame& frame, const Rigid3d* cur_from_prev_guess,
                      const MotionMatrix* guess_covariance) {
  return Track(PreparedFrame(frame.Clone()), cur_from_prev_guess,
               guess_covariance);
}

SlamFrame Slam::Track(const PreparedFrame& frame,
                      const Rigid3d* cur_from_prev_guess,
                      const MotionMatrix* guess_covariance) {
  SlamFrame result;
  result.tracked =
      odometry_.Track(frame, cur_from_prev_guess, guess_covariance);
  const TrackedFrame& tracked = result.tracked;
  if (tracked.previous_is_reference) BecomeReference(previous_);
  if (is_previous_late_ || tracked.previous_is_reference) {
    AddKeyframe(previous_);
  }
  Follow(tracked);
  is_previous_late_ = tracked.is_reference && odometry_.HasShutter(frame);
  if (tracked.is_reference && !is_previous_late_) AddKeyframe(tracked);
  previous_ = tracked;
  if (tracked.status == TrackingStatus::kLost && !search_.has_value()) {
    search_ = {tracked.index + settings_.update_delay,
               worker_.Submit([this, frame] { return mapper_.Find(frame); })};
  }
  ApplyPendingUpdates(tracked.index, &result);
  result.odom_from_cam = odom_from_cam_;
  result.map_from_odom = map_from_odom_;
  result.segment = reference_ ? segments_.at(*reference_) : first_segment_;
  return result;
}

// Updates odom_from_cam_ without a jump when the reference changes.
void Slam::Follow(const TrackedFrame& tracked) {
  const Rigid3d moved =
      previous_.world_from_cam.Inverse() * tracked.world_from_cam;
  const bool is_lost = tracked.status == TrackingStatus::kLost;
  // The second lost frame in a row may start a segment.
  if (is_lost && !tracked.is_reference) {
    if (tracked.is_predicted) odom_from_cam_ = odom_from_cam_ * moved;
    return;
  }
  const int id = MapId(tracked.index);
  if (tracked.reference == -1) {
    path_.push_back({tracked.timestamp, id, Rigid3d()});
  } else {
    const int reference = MapId(tracked.reference);
    const Rigid3d& cur_from_ref = tracked.cur_from_reference;
    if (reference != reference_) {
      // The frame has moved to an earlier reference: use its motion from the
      // previous one, if that was measured.
      const auto left = std::find_if(tracked.edges.begin(), tracked.edges.end(),
                                     [&](const RelativePose& edge) {
                                       return MapId(edge.ref) == reference_ &&
                                              edge.cur == tracked.index;
                                     });
      if (left != tracked.edges.end()) {
        odom_from_cam_ = odom_from_reference_ * left->cur_from_ref.Inverse();
      } else if (!tracked.relocalised) {
        odom_from_cam_ = odom_from_cam_ * moved;
      }
      reference_ = reference;
      odom_from_reference_ = odom_from_cam_ * cur_from_ref;
    }
    odom_from_cam_ = odom_from_reference_ * cur_from_ref.Inverse();
    path_.push_back({tracked.timestamp, reference, cur_from_ref.Inverse()});
    map_from_odom_ =
        map_from_keyframe_.at(reference) * odom_from_reference_.Inverse();
  }
  if (tracked.is_reference) BecomeReference(tracked);
  if (is_lost) path_.pop_back();
}

// Requires that the last frame of path_ is the new keyframe.
void Slam::BecomeReference(const TrackedFrame& tracked) {
  const int id = MapId(tracked.index);
  path_.back() = {tracked.timestamp, id, Rigid3d()};
  pending_.push_back({id, std::nullopt, Rigid3d()});
  if (tracked.reference != -1) {
    pending_.back().ref = *reference_;
    pending_.back().ref_from_cam = tracked.cur_from_reference.Inverse();
  }
  map_from_keyframe_[id] = map_from_odom_ * odom_from_cam_;
  segments_[id] = tracked.reference == -1 || !reference_.has_value()
                      ? first_segment_ + tracked.segment
                      : segments_.at(*reference_);
  reference_ = id;
  odom_from_reference_ = odom_from_cam_;
}

void Slam::AddKeyframe(const TrackedFrame& tracked) {
  Keyframe keyframe = *odometry_.FindKeyframe(tracked.index);
  keyframe.id = MapId(tracked.index);
  keyframe.segment = segments_.at(keyframe.id);
  keyframe.world_from_cam = map_from_keyframe_.at(keyframe.id);
  std::vector<RelativePose> edges;
  if (tracked.reference != -1) edges = tracked.edges;
  for (RelativePose& edge : edges) edge.ref = MapId(edge.ref);
  updates_.push_back({tracked.index + settings_.update_delay,
                      worker_.Submit([this, keyframe = std::move(keyframe),
                                      edges = std::move(edges)]() mutable {
                        return mapper_.Add(std::move(keyframe), edges);
                      })});
}

void Slam::ApplyPendingUpdates(int frame, SlamFrame* result) {
  const auto wait_for = [result](auto pending) {
    const StageTimer timer(&result->wait_ms);
    return pending.result.get();
  };
  while (!updates_.empty() && updates_.front().frame <= frame) {
    auto next = std::move(updates_.front());
    updates_.pop_front();  // first, as the result may be an exception
    Apply(wait_for(std::move(next)), result);
  }
  if (!search_.has_value() || search_->frame > frame) return;
  auto search = std::move(*search_);
  search_.reset();
  const std::optional<Keyframe> found = wait_for(std::move(search));
  const bool is_lost = result->tracked.status == TrackingStatus::kLost;
  if (found.has_value() && is_lost) Adopt(*found);
}

void Slam::Apply(MapUpdate update, SlamFrame* result) {
  for (const auto& [id, place] : update.moved) {
    map_from_keyframe_[id] = place.map_from_cam;
    segments_[id] = place.segment;
  }
  // Keyframes newer than the update move with their reference keyframes.
  if (!pending_.empty()) pending_.pop_front();  // the keyframe of this update
  for (const Pending& keyframe : pending_) {
    if (!keyframe.ref.has_value()) continue;
    map_from_keyframe_[keyframe.id] =
        map_from_keyframe_.at(*keyframe.ref) * keyframe.ref_from_cam;
    segments_[keyframe.id] = segments_.at(*keyframe.ref);
  }
  if (reference_.has_value()) {
    map_from_odom_ =
        map_from_keyframe_.at(*reference_) * odom_from_reference_.Inverse();
  }
  links_.insert(links_.end(), update.links.begin(), update.links.end());
  result->pairs += update.pairs;
  result->loops += update.loops;
  result->joined += update.joined;
  result->map_ms += update.ms;
  if (!update.error.empty()) result->error = update.error;
  error_ = std::move(update.error);
  if (update.returned_to.has_value()) Adopt(*update.returned_to);
}

// Inserts a map keyframe into the odometry, placed relative to the camera.
void Slam::Adopt(Keyframe keyframe) {
  const Rigid3d map_from_cam = map_from_odom_ * odom_from_cam_;
  keyframe.world_from_cam = previous_.world_from_cam * map_from_cam.Inverse() *
                            map_from_keyframe_.at(keyframe.id);
  keyframe.id -= first_id_;  // the odometry numbers its frames from 0
  odometry_.InsertKeyframe(keyframe);
}

void Slam::Finish() {
  SlamFrame unused;
  if (is_previous_late_) AddKeyframe(previous_);
  is_previous_late_ = false;
  search_.reset();  // too late to be of use
  ApplyPendingUpdates(std::numeric_limits<int>::max(), &unused);
  if (meter_.has_value()) {
    meter_->CorrectBy(odometry_.imu());
    MeasureUps();
  }
  Apply(worker_.Submit([this] { return mapper_.Finish(); }).get(), &unused);
  if (meter_.has_value()) FindGravity();
}

Trajectory Slam::Path() const {
  Trajectory path;
  for (const PathFrame& frame : path_) {
    path.push_back({frame.timestamp, map_from_keyframe_.at(frame.keyframe) *
                                         frame.keyframe_from_cam});
  }
  return path;
}

std::vector<int> Slam::PathSegments() const {
  std::vector<int> segments;
  for (const PathFrame& frame : path_) {
    segments.push_back(segments_.at(frame.keyframe));
  }
  return segments;
}

std::vector<Setting> SettingTable(SlamSettings* settings) {
  constexpr std::string_view kGroup = "Mapping";
  MappingOptions* mapping = &settings->mapping;
  return {
      {"max_pairs", kGroup,
       "number of older keyframes with a common view that a new keyframe is "
       "matched with",
       &mapping->max_pairs},
      {"min_pair_share", kGroup,
       "share of the view (0 to 1) that two keyframes must have in common",
       &mapping->min_pair_share},
      {"max_loop_candidates", kGroup,
       "similar-looking keyframes that are verified as loop candidates; 0: "
       "loops are found by pose alone",
       &mapping->max_loop_candidates},
      {"drift", kGroup,
       "assumed drift, as a standard deviation relative to the distance and "
       "the rotation travelled; limits what a loop may correct",
       &mapping->drift},
      {"window", kGroup,
       "number of keyframes whose poses are optimised with each new keyframe; "
       "after a loop all are",
       &mapping->window},
      {"update_delay", kGroup, "latency of map updates, in frames",
       &settings->update_delay},
      {"upright", kGroup,
       "turn the world so that z is up, if an inertial sensor says where that "
       "is; a loaded map is never turned",
       &settings->upright},
  };
}

}  // namespace rgbd_pose
