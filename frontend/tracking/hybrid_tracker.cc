#include "frontend/tracking/hybrid_tracker.h"

#include <utility>

#include "core/util/stage_timer.h"

namespace rgbd_pose {
namespace {

// Features and pixels contradict each other if their motions differ by more
// than this many sigmas of the summed covariances. The limit is wide, because
// errors that both share count twice there and calibration errors not at all.
constexpr double kMaxDifference = 8.0;

bool Agree(const TrackingResult& tracked, const MotionEstimate& pixels) {
  const MotionEstimate& features = tracked.estimate;
  return SquaredMahalanobisDistance(
             pixels.cur_from_prev, features.cur_from_prev,
             features.covariance / tracked.covariance_factor +
                 pixels.covariance) <=
         6.0 * kMaxDifference * kMaxDifference;  // false for NaN
}

// The frame with the velocity that was found with its motion.
PreparedFrame WithVelocity(const PreparedFrame& frame,
                           const TrackingResult& tracked) {
  return tracked.velocity.has_value() ? frame.WithTwist(tracked.velocity->twist)
                                      : frame;
}

}  // namespace

HybridTracker::HybridTracker(std::unique_ptr<FeatureTracker> features,
                             std::unique_ptr<DirectTracker> direct,
                             bool refines)
    : features_(std::move(features)),
      direct_(std::move(direct)),
      refines_(refines),
      pixels_(features_->images().camera),
      alone_(pixels_) {}

std::unique_ptr<Reference> HybridTracker::MakeReference(
    const PreparedFrame& frame, const Reference* last,
    const TrackingResult* tracked, std::string* why_not) {
  // If pixels alone tracked the frame, its features were not checked.
  const bool by_features = last != nullptr && last->features != nullptr &&
                           tracked->source != TrackingSource::kDirect;
  auto pixels = direct_->MakeReference(frame, nullptr, nullptr, why_not);
  // After the pixels, as the reason of the features counts.
  auto reference =
      features_->MakeReference(frame, by_features ? last : nullptr,
                               by_features ? tracked : nullptr, why_not);
  if (pixels == nullptr) return reference;
  if (reference != nullptr) {
    pixels->features = std::move(reference->features);
  } else if (!refines_) {
    return nullptr;
  }
  return pixels;
}

void HybridTracker::MoveReference(const PreparedFrame& frame,
                                  const Rigid3d& reference_from_stamp,
                                  Reference* reference) const {
  if (reference->features != nullptr) {
    features_->MoveReference(frame, reference_from_stamp, reference);
  }
  if (reference->pixels != nullptr) {
    direct_->MoveReference(frame, reference_from_stamp, reference);
  }
}

std::optional<Rigid3d> HybridTracker::AlignCoarsely(
    const PreparedFrame& prev, const PreparedFrame& cur,
    const Rigid3d& cur_from_prev_start, bool has_shutter) {
  // Depth exposed at another time than gray levels contradicts them as soon as
  // the velocity changes. So gray levels alone come first.
  if (has_shutter) {
    PreparedFrame gray = cur;
    gray.depth.release();
    const std::optional<Rigid3d> aligned =
        direct_->AlignCoarsely(prev, gray, cur_from_prev_start, has_shutter);
    if (aligned.has_value()) return aligned;
  }
  return direct_->AlignCoarsely(prev, cur, cur_from_prev_start, has_shutter);
}

void HybridTracker::Track(const Reference& reference,
                          const PreparedFrame& frame,
                          const TrackingGuess& guess, TrackingResult* tracked) {
  if (reference.features == nullptr) {
    tracked->Begin(TrackingSource::kFeatures);
    tracked->estimate = MotionEstimate();
    tracked->status = TrackingStatus::kLost;
    tracked->reason = "the reference has no features";
  } else {
    double start_ms = 0.0;
    TrackingGuess aligned = guess;
    if (reference.pixels != nullptr && !guess.search_at.has_value()) {
      const StageTimer timer(&start_ms);
      aligned.search_at = direct_->FindStart(reference, frame, guess);
    }
    features_->Track(reference, frame, aligned, tracked);
    tracked->match_ms += start_ms;
  }
  AddPixels(reference, frame, guess, tracked);
}

void HybridTracker::TrackAgain(const Reference& reference,
                               const PreparedFrame& frame,
                               const TrackingGuess& guess,
                               TrackingResult* tracked) {
  if (tracked->source == TrackingSource::kDirect) {
    direct_->TrackAgain(reference, frame, guess, tracked);
    return;
  }
  tracked->source = TrackingSource::kFeatures;
  features_->TrackAgain(reference, frame, guess, tracked);
  AddPixels(reference, frame, guess, tracked);
}

void HybridTracker::AddPixels(const Reference& reference,
                              const PreparedFrame& frame,
                              const TrackingGuess& guess,
                              TrackingResult* tracked) {
  if (!refines_ || reference.pixels == nullptr) return;
  const bool is_clear =
      tracked->status == TrackingStatus::kOk || tracked->is_ambiguous;
  // Pixels alone take twice as long as features from the next guess.
  if (guess.is_tentative && reference.features != nullptr && !is_clear) {
    tracked->is_partial = true;
    return;
  }
  if (tracked->status == TrackingStatus::kLost) {
    // A motion from few features may be wrong: use pixels alone.
    direct_->Track(reference, frame, guess, &pixels_);
    pixels_.match_ms += tracked->match_ms;
    if (pixels_.status == TrackingStatus::kLost) {
      tracked->reason += "; pixels alone: " + pixels_.reason;
    } else {
      std::swap(*tracked, pixels_);
    }
    return;
  }
  tracked->aligns_depth = guess.aligns_depth;
  tracked->needs_refinement = true;
  if (!guess.leaves_refinement) Refine(reference, frame, guess, tracked);
}

void HybridTracker::Refine(const Reference& reference,
                           const PreparedFrame& frame,
                           const TrackingGuess& guess,
                           TrackingResult* tracked) {
  if (!tracked->needs_refinement) return;
  tracked->needs_refinement = false;
  const bool is_refined = RefineByPixels(reference, frame, tracked);
  if (tracked->status != TrackingStatus::kOk && !tracked->is_ambiguous) {
    Confirm(reference, frame, guess, is_refined, tracked);
  }
}

bool HybridTracker::RefineByPixels(const Reference& reference,
                                   const PreparedFrame& frame,
                                   TrackingResult* tracked) {
  direct_->RefineWithMatches(reference, WithVelocity(frame, *tracked), *tracked,
                             &pixels_);
  if (tracked->velocity.has_value()) {
    pixels_.estimate.covariance += tracked->velocity->motion_covariance;
  }
  tracked->estimate.iterations += pixels_.estimate.iterations;
  tracked->estimate.solve_ms += pixels_.estimate.solve_ms;
  if (pixels_.status != TrackingStatus::kOk ||
      !Agree(*tracked, pixels_.estimate)) {
    return false;
  }
  tracked->source = TrackingSource::kBoth;
  tracked->estimate.cur_from_prev = pixels_.estimate.cur_from_prev;
  tracked->estimate.covariance =
      tracked->covariance_factor * pixels_.estimate.covariance;
  // A reference with few features is judged by the overlap of its pixels.
  if (tracked->needs_new_keyframe) {
    tracked->needs_new_keyframe = false;
    tracked->overlap = pixels_.overlap;
  }
  return true;
}

void HybridTracker::Confirm(const Reference& reference,
                            const PreparedFrame& frame,
                            const TrackingGuess& guess, bool is_refined,
                            TrackingResult* tracked) {
  direct_->Track(reference, WithVelocity(frame, *tracked), guess, &alone_);
  if (alone_.status != TrackingStatus::kOk) return;
  if (Agree(*tracked, alone_.estimate)) {
    tracked->status = TrackingStatus::kOk;
    tracked->reason.clear();
    if (is_refined) return;
  } else {
    tracked->reason += "; pixels alone give a different motion";
  }
  alone_.status = tracked->status;
  alone_.reason = tracked->reason;
  alone_.match_ms += tracked->match_ms;
  alone_.estimate.iterations += tracked->estimate.iterations;
  alone_.estimate.solve_ms += tracked->estimate.solve_ms;
  std::swap(*tracked, alone_);
}

void HybridTracker::OnAccepted(Reference* reference, TrackingResult* tracked) {
  if (reference->features == nullptr ||
      tracked->source == TrackingSource::kDirect) {
    return;
  }
  const Overlap overlap = tracked->overlap;
  features_->OnAccepted(reference, tracked);
  // Keep the overlap of the pixels (see Track) if it is larger.
  if (overlap.share > tracked->overlap.share) tracked->overlap = overlap;
}

}  // namespace rgbd_pose
