#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/estimation/estimator.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/reference.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// The estimators of motions from pixels.
struct DirectEstimators {
  // Starts from a guess, with direct costs whose losses have a wide basin.
  Estimator leading;
  // Starts from the result of `leading` or of matches, with direct costs whose
  // losses reject moving objects, and with matches if there are any.
  Estimator refining;
  // Finds a start in coarse images; nothing: the guess is the start.
  std::optional<Estimator> coarse = std::nullopt;
};

// Finds the motion by direct costs alone. It works in rooms without texture,
// but its basin of convergence is some pixels of the coarsest level.
class DirectTracker final : public Tracker {
 public:
  // Throws InputError for invalid options (see Check).
  DirectTracker(const FrontendOptions& images, DirectEstimators estimators,
                const TrackerOptions& options = {});

  void Prepare(const PreparedFrame& frame) const override;
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const TrackingResult* tracked,
                                           std::string* why_not) override;
  void MoveReference(const PreparedFrame& frame,
                     const Rigid3d& reference_from_stamp,
                     Reference* reference) const override;
  std::optional<Rigid3d> AlignCoarsely(const PreparedFrame& prev,
                                       const PreparedFrame& cur,
                                       const Rigid3d& cur_from_prev_start,
                                       bool has_shutter) override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, TrackingResult* tracked) override;
  void TrackAgain(const Reference& reference, const PreparedFrame& frame,
                  const TrackingGuess& guess, TrackingResult* tracked) override;
  // Estimates the motion from matches and pixels together, without pixels where
  // features contradict the motion, from the motion and prior of the matches.
  void RefineWithMatches(const Reference& reference, const PreparedFrame& frame,
                         const TrackingResult& by_features,
                         TrackingResult* tracked);
  // Returns the motion that aligns the coarse images of reference and frame, as
  // a start for tracking; the guess if they do not determine one.
  Rigid3d FindStart(const Reference& reference, const PreparedFrame& frame,
                    const TrackingGuess& guess);
  const FrontendOptions& images() const override { return images_; }

 private:
  // `by_features`: their matches are used as well; null: only pixels.
  void Estimate(const FrameView& prev, const PreparedFrame& frame,
                const Rigid3d& start, const MotionPrior& prior,
                const TrackingResult* by_features, Estimator* estimator,
                MotionEstimate* estimate) const;
  // Estimates the velocity from the motion, then the motion again with it.
  void FindTwist(const Reference& reference, const PreparedFrame& frame,
                 const TrackingGuess& guess, TrackingResult* tracked);
  // Sets what follows from the estimate. `is_alone`: without features.
  void Judge(const Reference& reference, const PreparedFrame& frame,
             bool is_alone, TrackingResult* tracked) const;

  FrontendOptions images_;
  DirectEstimators estimators_;
  MotionEstimate start_;
  TrackerOptions options_;
  mutable uint64_t last_id_ = 0;  // of references
};

}  // namespace rgbd_pose
