#pragma once

#include <vector>

#include "core/estimation/correspondences.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/twist.h"
#include "frontend/tracking/velocity_prior.h"

namespace rgbd_pose {

// The velocity of a frame, determined from its rows and from a prior.
struct TwistEstimate {
  Twist twist;

  // Covariance of the twist (angular, then linear).
  MotionMatrix covariance = MotionMatrix::Zero();

  // Derivative of the motion by the twist with which the frame is corrected.
  // The motion changes by a rotation vector, then a translation, both in
  // current axes.
  MotionMatrix motion_by_twist = MotionMatrix::Zero();

  // The part of the motion's covariance that is due to the uncertainty of the
  // velocity, defined as in MotionEstimate::covariance.
  MotionMatrix motion_covariance = MotionMatrix::Zero();
};

// What a prior alone says of a velocity: it is the mean `timing.twist`, and the
// motion was determined when the middle row was exposed.
TwistEstimate ExpectedTwist(const FrameTiming& timing,
                            const VelocityPrior& prior);

// Estimates a change of the motion and a change of the velocity together, by
// linear least squares over the inliers of `matches`. Their observations of the
// current frame are corrected with timing.twist; `sigma` is the spread of their
// residuals, see MotionEstimate. If rows are exposed one after another, a
// velocity shears and stretches the image, which no motion does. An error of
// the reference's velocity shears its points alike, so rows tell no more than
// the difference of both (see VelocityPrior::reference_covariance). Only the
// change of the velocity is used: the motion has to be estimated again from
// matches corrected with it.
TwistEstimate EstimateTwist(const Correspondences& matches,
                            const std::vector<bool>& is_inlier, double sigma,
                            const Rigid3d& cur_from_ref,
                            const FrameTiming& timing, const Twist& prior_mean,
                            const VelocityPrior& prior);

}  // namespace rgbd_pose
