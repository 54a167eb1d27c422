#pragma once

#include <memory>
#include <string>

#include "core/correspondences.h"
#include "core/estimator.h"
#include "core/initial_guess.h"
#include "core/rigid3.h"
#include "frontend/frontend.h"

namespace rgbd_pose {

enum class TrackingStatus {
  kOk,
  kDegraded,  // a pose, but from few or contradicting matches
  kLost,      // no pose: the last one is held
};

// "ok", "degraded", "lost"
const char* ToString(TrackingStatus status);

// What became of one input frame.
struct TrackedFrame {
  int index = 0;
  double timestamp = 0.0;  // s
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;         // in words; empty if ok
  Rigid3d world_from_cam;     // the world is the camera of the first frame
  bool is_reference = false;  // became the reference of the frames that follow
  int matches = 0;
  int inliers = 0;
  int iterations = 0;
  double sigma = 0.0;        // spread of whitened residuals; ideally 1
  double track_ms = 0.0;     // all of Track
  double frontend_ms = 0.0;  // of it: features and matching
  double solve_ms = 0.0;     // of it: motion estimation
};

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

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Tracks a camera frame by frame against a reference frame (keyframe), which
// it changes when the view has changed. Every frame gets a result.
class Odometry {
 public:
  Odometry(const OdometryOptions& options, const Camera& camera,
           std::unique_ptr<Frontend> frontend, Estimator estimator);

  TrackedFrame Track(const Frame& frame);

 private:
  // Tries to track from one guess; true if the result is a pose.
  bool TryGuess(const Frame& frame, const Rigid3d& cur_from_ref_guess,
                TrackedFrame* result);
  // Fills estimate_ from found_.
  void Estimate(const Rigid3d& cur_from_ref_guess);
  void TakeReference(const Frame& frame, TrackedFrame* result);
  bool NeedsNewReference(int inliers) const;
  double MeanInlierFlowPx() const;

  OdometryOptions options_;
  std::unique_ptr<Frontend> frontend_;
  Estimator estimator_;
  FeatureMatches found_;
  std::unique_ptr<FeatureSet> reference_;  // null: none yet
  MotionEstimate estimate_;
  Rigid3d world_from_ref_;
  Rigid3d cur_from_ref_;   // of the last frame
  Rigid3d cur_from_prev_;  // between the last two frames
};

}  // namespace rgbd_pose
