#include <optional>
#include <string>
#include <utility>

#include "core/util/stage_timer.h"
#include "frontend/tracking/odometry.h"

// If the reference does not yield the pose of a frame: track against the
// previous frame, search for the place, or start a new segment.

namespace rgbd_pose {

// Whether the pose of the frame is certain enough for it to become a reference.
bool Odometry::IsTrusted(const PreparedFrame* frame,
                         const TrackedFrame& result) const {
  constexpr double kMaxSigma = 1.7;
  if (frame == nullptr) return false;
  const bool is_certain = result.sigma <= kMaxSigma;
  // A new reference would not know what moves by itself.
  if (attempts_.kept().is_ambiguous) return is_certain;
  if (result.status != TrackingStatus::kOk) return false;
  return !NeedsNewReference() ||
         (is_certain && !attempts_.kept().needs_new_keyframe);
}

const PreparedFrame* Odometry::LookFromLast(
    const PreparedFrame& measured, const std::optional<Prediction>& prediction,
    const PreparedFrame* found, TrackedFrame* result) {
  OdometryKeyframe* const reference = reference_;
  const Rigid3d cur_from_ref = cur_from_ref_;
  const MotionMatrix covariance = covariance_;
  const ShutterTracking shutter_tracking = shutter_tracking_;
  const TrackingResult kept = attempts_.kept();
  if (!MakeLastReference(result)) return found;
  TrackedFrame from_last = *result;
  std::optional<Prediction> since;
  if (prediction.has_value()) {
    since = Predict(prediction->cur_from_prev, prediction->given);
  }
  const PreparedFrame* const frame = Look(measured, since, &from_last);
  result->iterations = from_last.iterations;
  result->match_ms = from_last.match_ms;
  result->solve_ms = from_last.solve_ms;
  result->relocalise_ms = from_last.relocalise_ms;
  const bool is_better =
      frame != nullptr &&
      (found == nullptr || (from_last.status == TrackingStatus::kOk &&
                            (result->status != TrackingStatus::kOk ||
                             from_last.sigma < result->sigma)));
  if (is_better) {
    *result = from_last;
    return frame;
  }
  reference_ = reference;
  cur_from_ref_ = cur_from_ref;
  covariance_ = covariance;
  shutter_tracking_ = shutter_tracking;
  attempts_.Restore(kept);
  return found;
}

bool Odometry::MakeLastReference(TrackedFrame* result) {
  if (!last_.has_value()) return false;
  const StageTimer timer(&result->reference_ms);
  std::string why_not;
  OdometryKeyframe* const added =
      AddKeyframe(*last_, nullptr, reference_, &why_not);
  if (added == nullptr) return false;
  reference_ = added;
  shutter_tracking_.AddReference(*added);
  result->previous_is_reference = true;
  last_.reset();
  cur_from_ref_ = Rigid3d();
  covariance_.setZero();
  return true;
}

bool Odometry::Relocalise(const PreparedFrame& frame, TrackedFrame* result) {
  std::optional<Relocalisation> place;
  {
    const StageTimer timer(&result->relocalise_ms);
    place = relocaliser_.Find(frame, keyframes_.Before(latest_segment_ + 1));
  }
  if (!place.has_value()) return false;
  OdometryKeyframe* keyframe = keyframes_.Find(place->keyframe);
  TrackingGuess guess = GuessOf(place->cur_from_keyframe);
  const VelocityPrior velocity = shutter_tracking_.velocity()->Prior(
      std::nullopt, interval_, frame.color_shutter.offset);
  if (has_shutter_ && interval_ > 0.0) guess.velocity = &velocity;
  if (!attempts_.Try(frame, *keyframe, guess, result) ||
      result->status != TrackingStatus::kOk) {
    return false;
  }
  // Another reference was waiting for a velocity.
  shutter_tracking_.HandleLost();
  twist_ = attempts_.kept().twist;
  if (twist_.has_value()) {
    shutter_tracking_.velocity()->Add(*twist_, frame.timestamp,
                                      frame.color_shutter.offset);
  }
  reference_ = keyframe;
  if (segment_ != keyframe->segment) earlier_segment_.reset();
  segment_ = keyframe->segment;
  TakeMotion(result);
  cur_from_prev_ = Rigid3d();
  result->relocalised = true;
  Accept(frame.WithTwist(twist_), result);
  return true;
}

void Odometry::HandleLost(const PreparedFrame& frame,
                          const std::optional<Prediction>& prediction,
                          TrackedFrame* result) {
  // After one lost frame without a guess, the motion since the loss is unknown.
  is_predicted_ = prediction.has_value() && (is_predicted_ || !is_lost_);
  // A new segment is best placed where the camera was heading.
  const Rigid3d moved_on =
      (is_lost_ ? Rigid3d() : cur_from_prev_) * cur_from_ref_;
  is_lost_ = true;
  shutter_tracking_.HandleLost();
  result->status = TrackingStatus::kLost;
  result->is_predicted = is_predicted_;
  if (prediction.has_value()) {
    cur_from_prev_ = prediction->cur_from_prev;
    cur_from_ref_ = prediction->cur_from_ref;
    covariance_ = prediction->covariance;
  } else if (options_.on_lost == LostPolicy::kPredict) {
    cur_from_ref_ = cur_from_prev_ * cur_from_ref_;
  } else {
    cur_from_prev_ = Rigid3d();
  }
  if (is_predicted_) {
    result->edges = {
        {reference_->id, result->index, cur_from_ref_, covariance_}};
  }
  if (options_.on_lost != LostPolicy::kNewSegment) return;
  const Rigid3d& start = prediction.has_value() ? cur_from_ref_ : moved_on;
  StartSegment(frame, reference_->world_from_cam * start.Inverse(), result);
}

void Odometry::StartSegment(const PreparedFrame& frame,
                            const Rigid3d& world_from_cam,
                            TrackedFrame* result) {
  const EarlierSegment earlier = {reference_->id, cur_from_ref_,
                                  frame.timestamp};
  const int before = segment_;
  segment_ = latest_segment_ + 1;
  if (!TakeReference(frame, world_from_cam, result)) {
    segment_ = before;
    return;
  }
  latest_segment_ = segment_;
  if (!earlier_segment_.has_value()) earlier_segment_ = earlier;
  is_lost_ = false;
  result->reference = -1;
  // The relation of two segments that start in a row is unknown: stay lost.
  if (!is_unconnected_) {
    result->status = TrackingStatus::kDegraded;
    result->reason =
        std::string("new segment: the motion since the previous frame is ") +
        (is_predicted_ ? "only predicted" : "unknown");
  }
  is_unconnected_ = true;
}

void Odometry::ReturnToEarlierSegment(const PreparedFrame& frame,
                                      TrackedFrame* result) {
  if (frame.timestamp - earlier_segment_->left_at >
      options_.new_segment_after) {
    earlier_segment_.reset();
    return;
  }
  OdometryKeyframe* found = keyframes_.Find(earlier_segment_->reference);
  if (found == nullptr ||
      !attempts_.TryFallback(frame, *found,
                             GuessOf(earlier_segment_->cur_from_ref), result)) {
    const StageTimer timer(&result->relocalise_ms);
    const auto place = relocaliser_.Find(frame, keyframes_.Before(segment_));
    if (!place.has_value()) return;
    found = keyframes_.Find(place->keyframe);
    if (!attempts_.TryFallback(frame, *found, GuessOf(place->cur_from_keyframe),
                               result)) {
      return;
    }
  }
  reference_ = found;
  segment_ = found->segment;
  result->relocalised = true;
  earlier_segment_.reset();
  TakeMotion(result);
}

}  // namespace rgbd_pose
