#include <memory>
#include <string>
#include <utility>

#include "core/util/stage_timer.h"
#include "frontend/tracking/odometry.h"

// What is kept of a frame whose pose has been found, and when it becomes a
// keyframe.

namespace rgbd_pose {
namespace {

// An earlier reference is used again if at least this share of it is in view,
// with at most this displacement (as a share of max_flow_px). Otherwise it
// would soon have to be replaced again.
constexpr double kMinReturnShare = 0.7;
constexpr double kMaxReturnFlow = 0.5;

}  // namespace

void Odometry::Accept(const PreparedFrame& frame, TrackedFrame* result) {
  state_.is_lost = false;
  state_.is_unconnected = false;
  if (is_repeated_) return;
  tracker_->OnAccepted(state_.reference->reference.get(),
                       attempts_.mutable_kept());
  if (!NeedsNewReference()) return;
  const Rigid3d world_from_cam = WorldFromCam();
  OdometryKeyframe* const earlier = keyframes_.FindNearest(
      world_from_cam, state_.segment, kMinReturnShare,
      kMaxReturnFlow * options_.max_flow_px, state_.reference);
  // If few features agree, only the refined pose shows how much is in view.
  const auto is_near = [&] {
    const TrackingResult& tracked = attempts_.kept();
    return !NeedsNewReference() ||
           (tracked.needs_new_keyframe && tracked.needs_refinement);
  };
  if (earlier != nullptr &&
      attempts_.TryFallback(
          frame, *earlier,
          GuessOf(world_from_cam.Inverse() * earlier->world_from_cam), result,
          is_near)) {
    state_.reference = earlier;
    TakeMotion(result);
    return;
  }
  TakeReference(frame, world_from_cam, result);
}

bool Odometry::NeedsNewReference() const {
  const TrackingResult& tracked = attempts_.kept();
  return tracked.needs_new_keyframe ||
         tracked.overlap.share < options_.min_reference_share ||
         tracked.overlap.flow_px > options_.max_flow_px;
}

bool Odometry::TakeReference(const PreparedFrame& frame,
                             const Rigid3d& world_from_cam,
                             TrackedFrame* result) {
  if (is_repeated_) return false;
  const StageTimer timer(&result->reference_ms);
  const bool is_lost = result->status == TrackingStatus::kLost;
  const bool was_tracked = state_.reference != nullptr && !is_lost;
  std::string why_not;
  MotionMatrix covariance = state_.timing_covariance;
  if (frame.twist.has_value()) covariance += state_.twist_covariance;
  OdometryKeyframe* const added =
      AddKeyframe({result->index,
                   state_.segment,
                   world_from_cam,
                   frame,
                   {},
                   {},
                   covariance},
                  was_tracked ? state_.reference->reference.get() : nullptr,
                  nullptr, &why_not);
  if (added == nullptr) {
    if (is_lost) result->reason = why_not;
    return false;
  }
  state_.reference = added;
  if (state_.has_shutter) state_.shutter_tracking.AddReference(added);
  state_.cur_from_ref = Rigid3d();
  state_.covariance.setZero();
  result->is_reference = true;
  return true;
}

OdometryKeyframe* Odometry::AddKeyframe(Keyframe keyframe,
                                        const Reference* last,
                                        const OdometryKeyframe* in_use,
                                        std::string* why_not) {
  std::unique_ptr<Reference> reference = tracker_->MakeReference(
      keyframe.frame, last, last != nullptr ? &attempts_.kept() : nullptr,
      why_not);
  if (reference == nullptr) return nullptr;
  keyframe.frame.color.release();
  return keyframes_.Add({std::move(keyframe), std::move(reference)}, in_use);
}

bool Odometry::InsertKeyframe(const Keyframe& inserted) {
  OdometryKeyframe* keyframe = keyframes_.Find(inserted.id);
  if (keyframe == nullptr) {
    std::string why_not;
    Keyframe added = inserted;
    added.segment = state_.segment;
    added.frame = inserted.Unpacked();
    added.images = {};
    RequireSize(added.frame);
    return AddKeyframe(std::move(added), nullptr, state_.reference, &why_not) !=
           nullptr;
  }
  if (keyframe == state_.reference) return true;
  keyframe->world_from_cam = inserted.world_from_cam;
  keyframe->segment = state_.segment;
  keyframes_.Renew(keyframe);
  return true;
}

bool Odometry::MakeLastReference(TrackedFrame* result) {
  if (!state_.last.has_value() || is_repeated_) return false;
  const StageTimer timer(&result->reference_ms);
  std::string why_not;
  OdometryKeyframe* const added =
      AddKeyframe(*state_.last, nullptr, state_.reference, &why_not);
  if (added == nullptr) return false;
  state_.reference = added;
  state_.shutter_tracking.AddReference(added);
  result->previous_is_reference = true;
  state_.last.reset();
  state_.cur_from_ref = Rigid3d();
  state_.covariance.setZero();
  return true;
}

}  // namespace rgbd_pose
