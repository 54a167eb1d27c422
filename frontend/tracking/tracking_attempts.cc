#include "frontend/tracking/tracking_attempts.h"

namespace rgbd_pose {

bool TrackingAttempts::Try(const PreparedFrame& frame,
                           const OdometryKeyframe& keyframe,
                           const TrackingGuess& guess, TrackedFrame* result) {
  tracked_.is_partial = false;
  tracker_->Track(*keyframe.reference, frame, guess, &tracked_);
  return Report(keyframe, result);
}

bool TrackingAttempts::TryAgain(const PreparedFrame& frame,
                                const OdometryKeyframe& keyframe,
                                const TrackingGuess& guess,
                                TrackedFrame* result) {
  result->match_ms -= tracked_.match_ms;
  tracker_->TrackAgain(*keyframe.reference, frame, guess, &tracked_);
  return Report(keyframe, result);
}

bool TrackingAttempts::Report(const OdometryKeyframe& keyframe,
                              TrackedFrame* result) const {
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
                              const TrackingGuess& guess,
                              TrackedFrame* result) {
  result->iterations -= tracked_.estimate.iterations;
  result->match_ms -= tracked_.match_ms;
  result->solve_ms -= tracked_.estimate.solve_ms;
  tracker_->Refine(*keyframe.reference, frame, guess, &tracked_);
  Report(keyframe, result);
}

bool TrackingAttempts::TryInTurn(const PreparedFrame& frame,
                                 const OdometryKeyframe& keyframe,
                                 const TrackingGuess& first,
                                 const TrackingGuess& second, const Find& find,
                                 TrackedFrame* result) {
  bool has_pose = false;
  const auto is_good = [&](TrackingGuess guess, bool is_tentative) {
    guess.is_tentative = is_tentative;
    if (has_pose) return TryFallback(frame, keyframe, guess, result);
    has_pose = Try(frame, keyframe, guess, result) && !tracked_.is_partial;
    return has_pose && result->status == TrackingStatus::kOk;
  };
  if (is_good(first, true)) return true;
  const bool is_ambiguous = tracked_.is_ambiguous;
  if (is_good(second, true)) return true;
  // If the view agrees with two motions, descriptors may find either.
  if (!is_ambiguous) {
    TrackingGuess third = first;
    if (find(&third.cur_from_ref) && is_good(third, true)) return true;
  }
  const bool has_slow_methods = tracked_.is_partial;
  for (const TrackingGuess* guess : {&first, &second}) {
    if (!has_pose && has_slow_methods) is_good(*guess, false);
  }
  return has_pose;
}

bool TrackingAttempts::TryFallback(const PreparedFrame& frame,
                                   const OdometryKeyframe& keyframe,
                                   TrackingGuess guess, TrackedFrame* result,
                                   const Accept& accept) {
  TrackedFrame attempt = *result;
  std::swap(tracked_, other_);
  guess.leaves_refinement = true;
  const auto is_accepted = [&] { return !accept || accept(); };
  if (Try(frame, keyframe, guess, &attempt) && is_accepted()) {
    Refine(frame, keyframe, guess, &attempt);
    if (attempt.status == TrackingStatus::kOk && is_accepted()) {
      *result = std::move(attempt);
      return true;
    }
  }
  std::swap(tracked_, other_);
  result->iterations = attempt.iterations;
  result->match_ms = attempt.match_ms;
  result->solve_ms = attempt.solve_ms;
  return false;
}

}  // namespace rgbd_pose
