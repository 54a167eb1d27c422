#include "frontend/tracking/tracking_attempts.h"

namespace rgbd_pose {

bool TrackingAttempts::Try(const PreparedFrame& frame,
                           const OdometryKeyframe& keyframe,
                           const TrackingGuess& guess, TrackedFrame* result) {
  tracked_.is_partial = false;
  tracker_->Track(*keyframe.reference, frame, guess, &tracked_);
  const MotionEstimate& estimate = tracked_.estimate;
  result->status = tracked_.status;
  result->reason = tracked_.reason;
  result->reference = keyframe.id;
  result->source = tracked_.source;
  result->matches = tracked_.num_found;
  result->inliers = estimate.num_inliers;
  result->iterations += estimate.iterations;
  result->sigma = estimate.sigma;
  result->match_ms += tracked_.match_ms;
  result->solve_ms += estimate.solve_ms;
  return tracked_.status != TrackingStatus::kLost;
}

void TrackingAttempts::Refine(const PreparedFrame& frame,
                              const OdometryKeyframe& keyframe,
                              TrackedFrame* result) {
  const MotionEstimate& estimate = tracked_.estimate;
  result->iterations -= estimate.iterations;
  result->solve_ms -= estimate.solve_ms;
  tracker_->Refine(*keyframe.reference, frame, &tracked_);
  result->source = tracked_.source;
  result->iterations += estimate.iterations;
  result->solve_ms += estimate.solve_ms;
}

bool TrackingAttempts::TryEither(const PreparedFrame& frame,
                                 const OdometryKeyframe& keyframe,
                                 const TrackingGuess& first,
                                 const TrackingGuess& second,
                                 TrackedFrame* result) {
  TrackingGuess tentative = first;
  tentative.is_tentative = true;
  const bool has_pose = Try(frame, keyframe, tentative, result);
  if (tracked_.is_partial) {
    if (Try(frame, keyframe, second, result) &&
        result->status == TrackingStatus::kOk) {
      return true;
    }
    return Try(frame, keyframe, first, result) ||
           Try(frame, keyframe, second, result);
  }
  if (!has_pose) return Try(frame, keyframe, second, result);
  if (result->status != TrackingStatus::kOk) {
    TryFallback(frame, keyframe, second, result);
  }
  return true;
}

bool TrackingAttempts::TryFallback(const PreparedFrame& frame,
                                   const OdometryKeyframe& keyframe,
                                   const TrackingGuess& guess,
                                   TrackedFrame* result, const Accept& accept) {
  TrackedFrame attempt = *result;
  std::swap(tracked_, other_);
  if (Try(frame, keyframe, guess, &attempt) &&
      attempt.status == TrackingStatus::kOk && (!accept || accept())) {
    *result = std::move(attempt);
    return true;
  }
  std::swap(tracked_, other_);
  result->match_ms = attempt.match_ms;
  result->solve_ms = attempt.solve_ms;
  return false;
}

}  // namespace rgbd_pose
