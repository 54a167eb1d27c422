#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/estimation/frame_view.h"
#include "core/estimation/motion_estimate.h"
#include "core/estimation/motion_prior.h"
#include "core/geometry/rigid3.h"
#include "core/initial_guess/initial_guess.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/view_overlap.h"
#include "frontend/tracking/tracked_frame.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

// What all trackers share.
struct TrackerOptions {
  // A frame is lost with fewer inliers, degraded with fewer than the second.
  int min_inliers = 15;
  int min_inliers_ok = 40;

  // A frame is degraded if a smaller share of its matches agrees.
  double min_inlier_share_ok = 0.35;

  // A frame is degraded if its residuals spread wider than this, in sigmas:
  // then most matches do not agree. Good frames stay below 3.
  double max_sigma_ok = 5.0;

  // Where the solver starts unless null: a motion found in the matches
  // themselves, instead of the guess.
  const InitialGuess* initial_guess = nullptr;

  // Standard deviations of the motion between two frames around a guess that
  // comes without a covariance, for costs with a prior.
  double prior_sigma_rotation = 0.05;     // rad
  double prior_sigma_translation = 0.05;  // m

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// What a tracker keeps of a frame that others are tracked against, whose images
// it shares, and what it has learnt of it since.
class Reference {
 public:
  virtual ~Reference() = default;

  // How much of it a camera there should see.
  virtual Overlap SeenFrom(const Rigid3d& cur_from_ref) const = 0;

  // Its images, if they are kept; else null.
  virtual const FrameView* images() const { return nullptr; }
};

// Where a frame is looked for.
struct TrackingGuess {
  // A motion of which no more is known, which is what most say.
  TrackingGuess(const Rigid3d& motion)  // NOLINT(*-explicit-*)
      : cur_from_ref(motion) {}

  // Where the search begins, and what priors are about.
  Rigid3d cur_from_ref;

  // Becomes the prior of costs that have one; null: not known.
  const MotionMatrix* covariance = nullptr;

  // Of the frame's velocity, where that has to be found, too; null: it stays
  // what the frame says.
  const VelocityPrior* velocity = nullptr;

  // If this guess does not lead to a good pose, another guess is tried next.
  // The tracker may skip its slow methods (see TrackingResult::is_partial).
  bool is_tentative = false;
};

// What is known of a motion by a guess: with its covariance, or with the
// options' standard deviations.
MotionPrior PriorOf(const TrackerOptions& options, const TrackingGuess& guess);

// How a frame was tracked against a reference.
struct TrackingResult {
  // Of that camera.
  explicit TrackingResult(const Camera& camera)
      : matches{Correspondences(camera), {}}, on_probation(matches) {}

  // Whether the motion can be gone on from.
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;  // in words; empty if ok

  // The motion with its covariance, counts and time. prev: the reference.
  MotionEstimate estimate;

  // What of the reference was found in the frame and agrees with the motion.
  Overlap overlap;

  // The velocity of the frame that was found with it; nothing: as it was.
  std::optional<Twist> twist;

  // What its uncertainty has added to the covariance of the motion.
  MotionMatrix twist_covariance = MotionMatrix::Zero();

  // That is so little that the next frames need another reference, whatever
  // share it is.
  bool needs_new_keyframe = false;

  // Matches agree with another motion nearly as well.
  bool is_ambiguous = false;

  // The pose is not good, and slow methods that might have improved it were
  // skipped because the guess was tentative.
  bool is_partial = false;

  // By features: where they contradict the motion.
  CellMask moving;

  // What the motion comes from.
  TrackingSource source = TrackingSource::kFeatures;
  int num_found = 0;  // matches, or pixels

  double match_ms = 0.0;  // time of all but the estimation

  // Of trackers that match features: what the estimate was made of, and what
  // had no say in it (FeatureValidation).
  FeatureMatches matches;
  FeatureMatches on_probation;
};

// Finds the motion between a reference and a frame. References are for trackers
// of the type that made them. One object serves one thread.
class Tracker {
 public:
  virtual ~Tracker() = default;

  // Makes what will be asked of the frame alone ahead: see Frontend::Prepare.
  virtual void Prepare(const PreparedFrame& frame) const = 0;

  // The frame as a reference for others; null, and why, if it shows too little.
  // Where the frame itself was tracked, `last` and `tracked` say against what
  // and how; both are null otherwise.
  virtual std::unique_ptr<Reference> MakeReference(
      const PreparedFrame& frame, const Reference* last,
      const TrackingResult* tracked, std::string* why_not) = 0;

  // Fills `tracked` (of the camera of images()), whose memory is used again.
  virtual void Track(const Reference& reference, const PreparedFrame& frame,
                     const TrackingGuess& guess, TrackingResult* tracked) = 0;

  // The motion is believed and gone on from: the reference may learn from it,
  // and `tracked` say what is shared in this light.
  virtual void OnAccepted(Reference* /*reference*/,
                          TrackingResult* /*tracked*/) {}

  // The camera and how its depths are to be taken.
  virtual const FrontendOptions& images() const = 0;
};

}  // namespace rgbd_pose
