#pragma once

#include <memory>
#include <string>

#include "core/estimation/estimator.h"
#include "core/geometry/rigid3.h"
#include "core/initial_guess/initial_guess.h"
#include "frontend/features/frontend.h"
#include "frontend/places/relocaliser.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// What to do with frames whose motion is not found. Whatever it is, every frame
// is searched for among earlier references, and tracking goes on if it is
// found.
enum class LostPolicy {
  kStop,        // every further frame is lost
  kHold,        // the last pose is reported until the place is found again
  kPredict,     // the pose moves on as it moved last
  kNewSegment,  // as kHold, and after a while a new segment starts
};

// When to believe a motion, change the reference, give up.
struct OdometryOptions {
  // A frame is lost with fewer inliers, degraded with fewer than the second.
  int min_inliers = 15;
  int min_inliers_ok = 40;

  // A frame is degraded if a smaller share of its matches agrees.
  double min_inlier_share_ok = 0.35;

  // A new reference is taken when fewer of the reference's features agree, or
  // when the inliers have moved further than this on average.
  double min_reference_share = 0.5;
  double max_flow_px = 60.0;

  // Where the solver starts: the last pose, moved on at constant velocity if
  // asked for, unless `initial_guess` finds a motion in the matches themselves.
  bool predict_velocity = false;
  const InitialGuess* initial_guess = nullptr;

  // Standard deviations of the motion between two frames around that start,
  // for costs with a prior.
  double prior_sigma_rotation = 0.05;     // rad
  double prior_sigma_translation = 0.05;  // m

  // What becomes of frames whose motion is not found.
  LostPolicy on_lost = LostPolicy::kNewSegment;

  // How long (s) the old segment is searched for before a new one starts.
  double new_segment_after = 1.5;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Tracks a camera frame by frame against a reference frame (keyframe), which
// it changes when the view has changed, to an earlier one if the view returns.
// Every frame gets a result.
class Odometry {
 public:
  // The options must be sound (see Check), the frontend made for that camera.
  Odometry(const OdometryOptions& options, const Camera& camera,
           std::unique_ptr<Frontend> frontend, Estimator estimator);

  // `cur_from_prev_guess`: the motion since the frame before, if something else
  // tells (wheels, an inertial sensor); tried first, and believed only as far
  // as the images agree. What is kept of the images is copied: the next ones
  // may be written into the same memory.
  TrackedFrame Track(const Frame& frame,
                     const Rigid3d* cur_from_prev_guess = nullptr);

  // The same for a frame that Prepare has made, here or in an odometry with the
  // same frontend.
  TrackedFrame Track(const PreparedFrame& frame,
                     const Rigid3d* cur_from_prev_guess = nullptr);

  // Works out what does not depend on other frames: may be done ahead, from any
  // thread, as long as this lives.
  std::unique_ptr<const PreparedFrame> Prepare(const Frame& frame) const {
    return frontend_->Prepare(frame);
  }

  // The pose after the last frame, found or not (see LostPolicy).
  Rigid3d WorldFromCam() const;

  // The matches that the last frame was tracked by (prev: its reference) and
  // what the estimator made of them.
  const FeatureMatches& last_matches() const { return found_; }
  const MotionEstimate& last_estimate() const { return estimate_; }

 private:
  void Start(const PreparedFrame& frame, TrackedFrame* result);
  bool Follow(const PreparedFrame& frame, const Rigid3d* cur_from_prev_guess,
              TrackedFrame* result);
  bool Relocalise(const PreparedFrame& frame, TrackedFrame* result);
  void Lose(const PreparedFrame& frame, TrackedFrame* result);

  // Tries to track against a reference from one guess; true if the result,
  // in estimate_, is a pose.
  bool Try(const PreparedFrame& frame, const Keyframe& reference,
           const Rigid3d& cur_from_ref_guess, TrackedFrame* result);
  // Fills estimate_ from found_.
  void Estimate(const Rigid3d& cur_from_ref_guess);
  // What follows from a frame tracked against reference_ as in estimate_.
  void Accept(const PreparedFrame& frame, TrackedFrame* result);
  void ChangeReference(const PreparedFrame& frame, TrackedFrame* result);
  bool NeedsNewReference() const;
  // Goes on from an earlier reference instead; false, and nothing has changed,
  // if it does not serve.
  bool ReturnTo(const PreparedFrame& frame, Keyframe* earlier,
                const Rigid3d& cur_from_earlier_guess, TrackedFrame* result);
  // Sets what the last Try has made aside, or takes it up again.
  void SwapAttempts();
  // False, and nothing has changed, if the frame has too few features.
  bool TakeReference(const PreparedFrame& frame, const Rigid3d& world_from_cam,
                     TrackedFrame* result);
  double MeanInlierFlowPx() const;

  OdometryOptions options_;
  std::unique_ptr<Frontend> frontend_;
  Estimator estimator_;
  Keyframes keyframes_;
  Relocaliser relocaliser_;
  FeatureMatches found_;
  MotionEstimate estimate_;
  FeatureMatches doubted_;      // of the last frame, see FeatureTrust
  FeatureMatches other_found_;  // see SwapAttempts
  FeatureMatches other_doubted_;
  MotionEstimate other_estimate_;
  Keyframe* reference_ = nullptr;  // null: none yet
  Rigid3d cur_from_ref_;           // of the last frame
  Rigid3d cur_from_prev_;          // between the last two frames
  int segment_ = 0;
  double tracked_at_ = 0.0;  // time stamp of the last frame with a pose, s
  bool is_lost_ = false;
};

}  // namespace rgbd_pose
