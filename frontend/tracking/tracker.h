#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/estimation/correspondences.h"
#include "core/estimation/frame_view.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/rigid3.h"
#include "core/initial_guess/initial_guess.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/view_overlap.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/twist_estimation.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

struct Reference;

// Whether there is a motion to judge. kNotConverged is accepted: its last step
// is some hundredths of a pixel.
inline bool HasMotion(const MotionEstimate& estimate) {
  return estimate.ok() || estimate.status == EstimateStatus::kNotConverged;
}

// Options of all trackers.
struct TrackerOptions {
  // With fewer inliers a frame is lost; below the second limit it is degraded.
  int min_inliers = 15;
  int min_inliers_ok = 40;

  // A frame is degraded if a smaller share of its matches agrees.
  double min_inlier_share_ok = 0.35;

  // A frame is degraded if its residuals spread wider than this, in sigmas:
  // most of its matches then disagree. Good frames stay below 3.
  double max_sigma_ok = 5.0;

  // With pixels, a frame is lost if a smaller share of its reference is seen as
  // predicted, or if neither grey levels nor depths agree with the reference by
  // this much. Right motions have at least 0.4 (half of the image covered) in
  // one of the two, wrong ones at most 0.1 in both.
  double min_seen_share = 0.15;
  double min_likeness = 0.25;

  // Finds the start of the solver in the matches; null: it is the guess.
  const InitialGuess* initial_guess = nullptr;

  // Standard deviations of the motion between two frames around a guess that
  // comes without a covariance. Used by costs with a prior.
  double prior_sigma_rotation = 0.05;     // rad
  double prior_sigma_translation = 0.05;  // m

  // Returns one line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Where to search for a frame.
struct TrackingGuess {
  // A motion about which nothing else is known; the usual case.
  TrackingGuess(const Rigid3d& motion)  // NOLINT(*-explicit-*)
      : TrackingGuess(motion, true) {}
  // `aligns`: see aligns_depth.
  TrackingGuess(const Rigid3d& motion, bool aligns)
      : cur_from_ref(motion), aligns_depth(aligns) {}

  // The start of the solver and the mean of priors.
  Rigid3d cur_from_ref;

  // Where features are searched for, if coarse images have been aligned
  // already.
  std::optional<Rigid3d> search_at;

  // Becomes the prior of costs that have one; null: unknown.
  const MotionMatrix* covariance = nullptr;

  // Prior of the velocity if the velocity of the frame is to be found as well;
  // null: use the velocity of the frame as it is.
  const VelocityPrior* velocity = nullptr;

  // If this guess does not lead to a good pose, another guess is tried next.
  // The tracker may skip its slow methods (see TrackingResult::is_partial).
  bool is_tentative = false;

  // The refinement by pixels is left to Tracker::Refine, as the reference may
  // move before or the pose may not be needed (see needs_refinement).
  bool leaves_refinement = false;

  // Whether depth and gray levels are of one moment: times are known, or the
  // camera is slow. If not, depth is not aligned where neighbours err alike.
  bool aligns_depth;
};

// Returns what a guess says about a motion, with the covariance of the guess or
// else the standard deviations of the options.
MotionPrior PriorOf(const TrackerOptions& options, const TrackingGuess& guess);

// The result of tracking a frame against a reference.
struct TrackingResult {
  // `camera`: of the frames.
  explicit TrackingResult(const Camera& camera)
      : matches{Correspondences(camera), {}}, on_probation(matches) {}

  // Clears what not every tracker fills, before the next frame.
  void Begin(TrackingSource tracked_from) {
    source = tracked_from;
    num_found = 0;
    match_ms = 0.0;
    is_ambiguous = false;
    needs_refinement = false;
    velocity.reset();
    covariance_factor = 1.0;
    matches.Clear();
    on_probation.Clear();
  }

  // Whether tracking can continue from the motion.
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;  // in words; empty if ok

  // The motion with its covariance, counts and time. prev: the reference.
  MotionEstimate estimate;

  // The part of the reference that was found and agrees with the motion.
  Overlap overlap;

  // The velocity of the frame, found with the motion; nothing: unchanged.
  std::optional<TwistEstimate> velocity;

  // The covariance was multiplied by this (see CovarianceInflation).
  double covariance_factor = 1.0;

  // So little of the reference was found that the next frames need another one,
  // whatever the share in `overlap`.
  bool needs_new_keyframe = false;

  // Whether matches agree with another motion nearly as well.
  bool is_ambiguous = false;

  // The pose is not good, and slow methods that might have improved it were
  // skipped because the guess was tentative.
  bool is_partial = false;

  // What the guess says about the motion (feature trackers only).
  MotionPrior prior;
  bool aligns_depth = true;

  // Whether Tracker::Refine has still to refine the pose.
  bool needs_refinement = false;

  // Regions where features contradict the motion (feature trackers only).
  CellMask moving;

  // What the motion was estimated from.
  TrackingSource source = TrackingSource::kFeatures;
  int num_found = 0;  // number of matches or pixels

  double match_ms = 0.0;  // time of everything except the estimation

  // The matches used by the estimate, and the matches that did not affect it
  // (see FeatureValidation). Filled by trackers that match features.
  FeatureMatches matches;
  FeatureMatches on_probation;
};

// Finds the motion between a reference and a frame. A reference works only with
// trackers of the type that made it. One object serves one thread.
class Tracker {
 public:
  virtual ~Tracker() = default;

  // Precomputes everything that needs the frame alone: see Frontend::Prepare.
  virtual void Prepare(const PreparedFrame& frame) const = 0;

  // Makes a reference of the frame. Returns null, and why, if it has too few
  // features or depths. `last` and `tracked`: against what and how the frame
  // itself was tracked; null if it was not.
  virtual std::unique_ptr<Reference> MakeReference(
      const PreparedFrame& frame, const Reference* last,
      const TrackingResult* tracked, std::string* why_not) = 0;

  // Moves what a reference keeps of its frame: the velocity of the frame is
  // known better now. `reference_from_stamp`: see FrameView.
  virtual void MoveReference(const PreparedFrame& frame,
                             const Rigid3d& reference_from_stamp,
                             Reference* reference) const = 0;

  // Aligns coarse images of two frames in a row. The motion may be some pixels
  // off. Returns nothing if the images do not determine it. `has_shutter`:
  // depth and rows were exposed at other times than the stamps.
  virtual std::optional<Rigid3d> AlignCoarsely(
      const PreparedFrame& /*prev*/, const PreparedFrame& /*cur*/,
      const Rigid3d& /*cur_from_prev_start*/, bool /*has_shutter*/) {
    return std::nullopt;
  }

  // Fills `tracked` (made for the camera of images()) and reuses its memory.
  virtual void Track(const Reference& reference, const PreparedFrame& frame,
                     const TrackingGuess& guess, TrackingResult* tracked) = 0;

  // Corrects `tracked`, the result of Track, after the reference has moved.
  // What was found in the frame, with the velocity of `frame`, is not searched
  // again.
  virtual void TrackAgain(const Reference& reference,
                          const PreparedFrame& frame,
                          const TrackingGuess& guess,
                          TrackingResult* tracked) = 0;

  // Refines a motion if Track has left that (see needs_refinement), with the
  // velocity found with it. A motion that was not ok may be confirmed.
  virtual void Refine(const Reference& /*reference*/,
                      const PreparedFrame& /*frame*/,
                      const TrackingGuess& /*guess*/,
                      TrackingResult* /*tracked*/) {}

  // Called when the motion is accepted and tracking continues from it. The
  // reference may learn from it and update the overlap in `tracked`.
  virtual void OnAccepted(Reference* /*reference*/,
                          TrackingResult* /*tracked*/) {}

  // The camera and how to use its depths.
  virtual const FrontendOptions& images() const = 0;
};

}  // namespace rgbd_pose
