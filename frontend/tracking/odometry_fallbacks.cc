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
  const State before = state_;
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
  state_ = before;
  attempts_.Restore(kept);
  return found;
}

bool Odometry::Relocalise(const PreparedFrame& frame, TrackedFrame* result) {
  std::optional<Relocalisation> place;
  {
    const StageTimer timer(&result->relocalise_ms);
    place =
        relocaliser_.Find(frame, keyframes_.Before(state_.latest_segment + 1));
  }
  if (!place.has_value()) return false;
  OdometryKeyframe* keyframe = keyframes_.Find(place->keyframe);
  TrackingGuess guess = GuessOf(place->cur_from_keyframe);
  VelocityPrior velocity = state_.shutter_tracking.velocity().Prior(
      std::nullopt, state_.interval, frame.color_shutter.offset);
  velocity.reference_covariance = keyframe->velocity_covariance;
  if (inertial_.has_value()) velocity.measured = inertial_->TwistDuring(frame);
  if (state_.has_shutter && state_.interval > 0.0) guess.velocity = &velocity;
  if (!attempts_.Try(frame, *keyframe, guess, result) ||
      result->status != TrackingStatus::kOk) {
    return false;
  }
  state_.shutter_tracking.Restart(frame, attempts_.kept());
  state_.twist.reset();
  if (attempts_.kept().velocity.has_value()) {
    state_.twist = attempts_.kept().velocity->twist;
  }
  state_.reference = keyframe;
  if (state_.segment != keyframe->segment) state_.earlier_segment.reset();
  state_.segment = keyframe->segment;
  TakeMotion(result);
  state_.cur_from_prev = Rigid3d();
  result->relocalised = true;
  Accept(frame.WithTwist(state_.twist), result);
  return true;
}

bool Odometry::GoOnBlindly(const Frame& frame, TrackedFrame* result) {
  if (!inertial_.has_value() || state_.is_lost) return false;
  // A doubtful frame may have become the reference since.
  OdometryKeyframe* const reference = keyframes_.Find(state_.seen.reference);
  if (reference == nullptr || reference->segment != state_.segment) {
    return false;
  }
  const std::optional<DeadReckoning::Motion> since_seen =
      inertial_->Since(frame.timestamp);
  if (!since_seen.has_value()) return false;
  const Rigid3d world_from_prev = WorldFromCam();
  const Rigid3d& cur_from_seen = since_seen->cur_from_last;
  const Rigid3d cur_from_ref = cur_from_seen * state_.seen.cur_from_ref;
  state_.reference = reference;
  state_.cur_from_ref = cur_from_ref;
  state_.cur_from_prev = WorldFromCam().Inverse() * world_from_prev;
  state_.covariance =
      ComposedCovariance(cur_from_seen, since_seen->covariance,
                         state_.seen.cur_from_ref, state_.seen.covariance);
  state_.shutter_tracking.HandleLost();
  if (state_.has_shutter && state_.interval > 0.0) GoOnWithVelocity(frame);
  result->status = TrackingStatus::kDegraded;
  result->reason = "no image: inertial sensor only";
  result->source = TrackingSource::kInertial;
  result->reference = state_.reference->id;
  result->cur_from_reference = cur_from_ref;
  result->matches = result->inliers = 0;
  result->sigma = 0.0;
  result->edges = {
      {result->reference, result->index, cur_from_ref, state_.covariance}};
  return true;
}

// The next frame with an image starts with this velocity, and so does this one
// if it becomes a reference.
void Odometry::GoOnWithVelocity(const Frame& frame) {
  VelocityPrior prior = state_.shutter_tracking.velocity().Prior(
      std::nullopt, state_.interval, frame.color_shutter.offset);
  prior.measured = inertial_->TwistDuring(frame);
  const Twist mean = TwistOf(state_.cur_from_prev, state_.interval);
  TrackingResult expected(tracker_->images().camera);
  expected.velocity = ExpectedTwist(frame.Timing(prior.Fused(mean)), prior);
  expected.estimate.cur_from_prev = state_.cur_from_ref;
  expected.estimate.covariance =
      state_.covariance + expected.velocity->motion_covariance;
  state_.shutter_tracking.Restart(frame, expected);
  state_.twist = expected.velocity->twist;
  state_.twist_covariance = expected.velocity->motion_covariance;
}

void Odometry::HandleLost(const PreparedFrame& frame,
                          const std::optional<Prediction>& prediction,
                          TrackedFrame* result) {
  // After one lost frame without a guess, the motion since the loss is unknown.
  state_.is_predicted =
      prediction.has_value() && (state_.is_predicted || !state_.is_lost);
  // A new segment is best placed where the camera was heading.
  const Rigid3d moved_on =
      (state_.is_lost ? Rigid3d() : state_.cur_from_prev) * state_.cur_from_ref;
  state_.is_lost = true;
  state_.shutter_tracking.HandleLost();
  result->status = TrackingStatus::kLost;
  result->is_predicted = state_.is_predicted;
  if (prediction.has_value()) {
    state_.cur_from_prev = prediction->cur_from_prev;
    state_.cur_from_ref = prediction->cur_from_ref;
    state_.covariance = prediction->covariance;
  } else if (options_.on_lost == LostPolicy::kPredict) {
    state_.cur_from_ref = state_.cur_from_prev * state_.cur_from_ref;
  } else {
    state_.cur_from_prev = Rigid3d();
  }
  if (state_.is_predicted) {
    result->edges = {{state_.reference->id, result->index, state_.cur_from_ref,
                      state_.covariance}};
  }
  if (options_.on_lost != LostPolicy::kNewSegment) return;
  const Rigid3d& start =
      prediction.has_value() ? state_.cur_from_ref : moved_on;
  StartSegment(frame, state_.reference->world_from_cam * start.Inverse(),
               result);
}

void Odometry::StartSegment(const PreparedFrame& frame,
                            const Rigid3d& world_from_cam,
                            TrackedFrame* result) {
  const EarlierSegment earlier = {state_.reference->id, state_.cur_from_ref,
                                  frame.timestamp};
  const int before = state_.segment;
  state_.segment = state_.latest_segment + 1;
  if (!TakeReference(frame, world_from_cam, result)) {
    state_.segment = before;
    return;
  }
  state_.latest_segment = state_.segment;
  if (!state_.earlier_segment.has_value()) state_.earlier_segment = earlier;
  state_.is_lost = false;
  result->reference = -1;
  // The relation of two segments that start in a row is unknown: stay lost.
  if (!state_.is_unconnected) {
    result->status = TrackingStatus::kDegraded;
    result->reason =
        std::string("new segment: the motion since the previous frame is ") +
        (state_.is_predicted ? "only predicted" : "unknown");
  }
  state_.is_unconnected = true;
}

void Odometry::ReturnToEarlierSegment(const PreparedFrame& frame,
                                      TrackedFrame* result) {
  if (frame.timestamp - state_.earlier_segment->left_at >
      options_.new_segment_after) {
    state_.earlier_segment.reset();
    return;
  }
  OdometryKeyframe* found = keyframes_.Find(state_.earlier_segment->reference);
  if (found == nullptr ||
      !attempts_.TryFallback(frame, *found,
                             GuessOf(state_.earlier_segment->cur_from_ref),
                             result)) {
    const StageTimer timer(&result->relocalise_ms);
    const auto place =
        relocaliser_.Find(frame, keyframes_.Before(state_.segment));
    if (!place.has_value()) return;
    found = keyframes_.Find(place->keyframe);
    if (!attempts_.TryFallback(frame, *found, GuessOf(place->cur_from_keyframe),
                               result)) {
      return;
    }
  }
  state_.reference = found;
  state_.segment = found->segment;
  result->relocalised = true;
  state_.earlier_segment.reset();
  TakeMotion(result);
}

}  // namespace rgbd_pose
