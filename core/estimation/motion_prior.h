#pragma once

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Knowledge of a motion from a source other than the two frames (wheels, an
// inertial sensor, a motion model). It is a factor of the estimate, not the
// starting point of the solver. Its covariance is taken as exact: the scatter
// of the matches does not change it.
struct MotionPrior {
  Rigid3d mean;  // cur_from_prev

  // Inverse of the covariance of [omega (rad), C (m)] as in MotionEstimate. May
  // be singular: an inertial sensor measures rotation only. Zero, or an invalid
  // information matrix, means that nothing is known.
  MotionMatrix information = MotionMatrix::Zero();
};

}  // namespace rgbd_pose
