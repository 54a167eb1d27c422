#pragma once

#include <vector>

#include "core/estimation/correspondences.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/twist.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

// A frame's velocity, as its rows and what came before it tell.
struct TwistEstimate {
  Twist twist;

  // What the uncertainty of the velocity adds to the covariance of the motion,
  // as MotionEstimate::covariance has it.
  MotionMatrix motion_covariance = MotionMatrix::Zero();
};

// Linear least squares over the inliers of `matches` (their observations of the
// current frame as moved by timing.twist; `sigma`: how wide their residuals
// spread, see MotionEstimate), for a change of the motion and one
// of the velocity at once: where rows are exposed one after another, velocity
// shears and stretches the image, which no motion does. Only that change of
// the velocity is used; the motion is to be estimated again from matches that
// are moved by it.
TwistEstimate EstimateTwist(const Correspondences& matches,
                            const std::vector<bool>& is_inlier, double sigma,
                            const Rigid3d& cur_from_ref,
                            const FrameTiming& timing, const Twist& prior_mean,
                            const VelocityPrior& prior);

}  // namespace rgbd_pose
