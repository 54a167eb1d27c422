#include <optional>
#include <utility>

#include "core/util/stage_timer.h"
#include "frontend/tracking/odometry.h"

// The pose of one frame: predicted by coarse images, found by features,
// refined by pixels.

namespace rgbd_pose {
namespace {

// After a frame with fewer features that agree, pixels are needed at once.
constexpr int kFewFeatures = 40;

}  // namespace

bool Odometry::Follow(const PreparedFrame& measured,
                      const std::optional<Prediction>& prediction,
                      TrackedFrame* result) {
  state_.aligned = AlignToLast(measured, prediction);
  if (!state_.aligned.has_value()) {
    state_.effort = Effort::kEverything;
  } else if (state_.has_few_features) {
    state_.effort = Effort::kPixels;
  } else {
    state_.effort = Effort::kQuick;
  }
  // Pixels confirm features from where these were searched for.
  const auto refine = [&](const PreparedFrame* seen) {
    if (seen == nullptr || !attempts_.kept().needs_refinement) return;
    const Rigid3d start =
        state_.aligned.value_or(Rigid3d()) * state_.cur_from_ref;
    attempts_.Refine(*seen, *state_.reference, GuessOf(start), result);
    state_.shutter_tracking.Update(attempts_.kept());
  };
  const PreparedFrame* frame = Look(measured, prediction, result);
  if (state_.effort == Effort::kPixels) refine(frame);
  if (!state_.is_lost && !IsTrusted(frame, *result)) {
    frame = LookFromLast(measured, prediction, frame, result);
  }
  while (frame == nullptr && state_.effort != Effort::kEverything) {
    state_.effort =
        state_.effort == Effort::kQuick ? Effort::kPixels : Effort::kEverything;
    frame = Look(measured, prediction, result);
  }
  refine(frame);
  // A doubtful pose does not end the lost state.
  if (frame == nullptr ||
      (state_.is_lost && result->status != TrackingStatus::kOk)) {
    return false;
  }
  const TrackingResult& tracked = attempts_.kept();
  state_.has_few_features = tracked.source == TrackingSource::kDirect ||
                            tracked.estimate.num_inliers < kFewFeatures;
  state_.twist = frame->twist;
  if (tracked.velocity.has_value()) {
    state_.twist_covariance = tracked.velocity->motion_covariance;
  }
  state_.cur_from_prev = state_.is_lost ? Rigid3d()
                                        : last_estimate().cur_from_prev *
                                              state_.cur_from_ref.Inverse();
  if (!state_.is_lost && state_.interval > 0.0) {
    state_.timing_covariance = TimingCovariance(
        measured, TwistOf(state_.cur_from_prev, state_.interval));
  }
  if (state_.has_shutter) {
    state_.shutter_tracking.Accept(tracked);
    state_.timing_covariance +=
        state_.shutter_tracking.acceleration_covariance();
  }
  TakeMotion(result);
  if (state_.earlier_segment.has_value()) {
    ReturnToEarlierSegment(*frame, result);
  }
  Accept(*frame, result);
  return true;
}

std::optional<Rigid3d> Odometry::AlignToLast(
    const PreparedFrame& frame, const std::optional<Prediction>& prediction) {
  if (state_.is_lost || state_.is_doubtful) return std::nullopt;
  const Keyframe* last = nullptr;
  if (state_.last.has_value()) {
    last = &*state_.last;
  } else if (state_.reference->id == num_frames_ - 2) {
    last = state_.reference;
  }
  if (last == nullptr) return std::nullopt;
  PreparedFrame seen = frame;
  seen.twist = last->frame.twist;
  return tracker_->AlignCoarsely(
      last->frame, seen,
      prediction.has_value() ? prediction->cur_from_prev : Expected(),
      state_.has_shutter);
}

Rigid3d Odometry::Expected() const {
  if (!state_.turn.has_value()) return state_.cur_from_prev;
  return Rigid3d(state_.turn->cur_from_prev, state_.cur_from_prev.translation);
}

// Tracks from where coarse images say that the camera is. Where they do not say
// it, from the last pose, and only then from a constant velocity, which can
// lock onto its own false motion.
bool Odometry::Try(const PreparedFrame& frame,
                   const std::optional<Prediction>& prediction,
                   const VelocityPrior* velocity, TrackedFrame* result) {
  const OdometryKeyframe& reference = *state_.reference;
  const bool tries_everything = state_.effort == Effort::kEverything;
  std::optional<Rigid3d> aligned;
  if (state_.aligned.has_value()) {
    aligned = *state_.aligned * state_.cur_from_ref;
  }
  const auto from = [&](const Rigid3d& cur_from_ref) {
    TrackingGuess guess = GuessOf(cur_from_ref);
    guess.velocity = velocity;
    guess.leaves_refinement = !tries_everything;
    return guess;
  };
  if (prediction.has_value()) {
    TrackingGuess guess = from(prediction->cur_from_ref);
    if (prediction->given != nullptr) {
      guess.covariance = &prediction->covariance;
    }
    guess.search_at = aligned;
    if (attempts_.Try(frame, reference, guess, result)) return true;
  }
  TrackingGuess first = from(state_.cur_from_ref);
  TrackingGuess second = from(Expected() * state_.cur_from_ref);
  // What a gyroscope has measured is no assumption.
  if (state_.turn.has_value()) std::swap(first, second);
  if (!tries_everything) {
    first.search_at = aligned;
    first.is_tentative = state_.effort == Effort::kQuick;
    return attempts_.Try(frame, reference, first, result) &&
           !attempts_.kept().is_partial;
  }
  return attempts_.TryInTurn(
      frame, reference, first, second,
      [&](Rigid3d* cur_from_ref) {
        const StageTimer timer(&result->relocalise_ms);
        return relocaliser_.FindIn(frame, state_.reference, cur_from_ref);
      },
      result);
}

std::optional<Twist> Odometry::TwistSinceLast(
    const std::optional<Prediction>& prediction) const {
  if (!(state_.interval > 0.0)) return std::nullopt;
  if (prediction.has_value()) {
    return TwistOf(prediction->cur_from_prev, state_.interval);
  }
  if (!state_.aligned.has_value() ||
      state_.shutter_tracking.velocity().last().has_value()) {
    return std::nullopt;
  }
  return TwistOf(*state_.aligned, state_.interval);
}

const PreparedFrame* Odometry::Look(const PreparedFrame& measured,
                                    const std::optional<Prediction>& prediction,
                                    TrackedFrame* result) {
  const auto track = [&](const PreparedFrame& frame,
                         const VelocityPrior* velocity) {
    return Try(frame, prediction, velocity, result);
  };
  if (!state_.has_shutter) {
    // A frame without a shutter among frames with one does not determine a
    // velocity, and the known velocity is older than this frame.
    state_.shutter_tracking.Forget();
    return track(measured, nullptr) ? &measured : nullptr;
  }
  const auto track_again = [&](const PreparedFrame& frame,
                               const VelocityPrior& velocity,
                               const Rigid3d& cur_from_ref) {
    TrackingGuess guess = GuessOf(cur_from_ref);
    guess.velocity = &velocity;
    guess.leaves_refinement = true;
    return attempts_.TryAgain(frame, *state_.reference, guess, result);
  };
  std::optional<MeasuredTwist> velocity;
  if (inertial_.has_value()) velocity = inertial_->TwistDuring(measured);
  std::optional<Rigid3d> prev_from_ref;
  if (!state_.is_lost) prev_from_ref = state_.cur_from_ref;
  return state_.shutter_tracking.Follow(
      measured, state_.interval, prev_from_ref, TwistSinceLast(prediction),
      velocity, state_.reference, attempts_.kept(), track, track_again);
}

void Odometry::TakeMotion(TrackedFrame* result) {
  const MotionEstimate& estimate = last_estimate();
  state_.cur_from_ref = estimate.cur_from_prev;
  state_.covariance = estimate.covariance;
  if (!attempts_.kept().velocity.has_value()) {
    state_.covariance += state_.twist_covariance;
  }
  state_.covariance +=
      state_.timing_covariance + state_.reference->timing_covariance;
  result->cur_from_reference = state_.cur_from_ref;
  if (!HasMotion(estimate)) return;
  result->edges.insert(result->edges.begin(),
                       {state_.reference->id, result->index,
                        state_.cur_from_ref, state_.covariance});
}

}  // namespace rgbd_pose
