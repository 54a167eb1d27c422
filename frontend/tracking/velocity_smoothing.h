#pragma once

#include "core/estimation/motion_estimate.h"
#include "core/geometry/twist.h"
#include "frontend/tracking/twist_estimation.h"

namespace rgbd_pose {

// A frame whose rows were exposed one after another, once the motion to the
// next frame is known.
struct SmoothedFrame {
  Twist twist;

  // Covariance of the twist (angular, then linear).
  MotionMatrix covariance = MotionMatrix::Zero();

  // By how much its motion changes: a rotation vector (rad), then a translation
  // (m), both in its own axes.
  MotionVector change = MotionVector::Zero();
};

// The mean of the camera's velocities before and after a frame.
struct MeanVelocity {
  Twist twist;

  // Covariance (angular, then linear) as the velocity at the frame itself,
  // without the part of the frame's own motion.
  MotionMatrix covariance = MotionMatrix::Zero();

  double seconds = 0.0;  // length of both intervals together
};

// Corrects velocity and motion of a frame by the mean velocity around it, in
// one step of a Kalman filter. `found`: the velocity as it was found with the
// motion; `motion_covariance`: of this motion for a given velocity, in its own
// axes (see CovarianceInCurrentAxes). An error of the velocity has moved the
// motion. An error of the motion itself is in the mean velocity, too: it makes
// the camera too fast before the frame.
SmoothedFrame Smooth(const TwistEstimate& found,
                     const MotionMatrix& motion_covariance,
                     const MeanVelocity& mean);

// Returns the covariance of a motion, without the part that is due to its
// velocity (see TwistEstimate; null: none), as that of a rotation vector and a
// translation in current axes.
MotionMatrix CovarianceInCurrentAxes(const MotionEstimate& estimate,
                                     const TwistEstimate* velocity);

}  // namespace rgbd_pose
