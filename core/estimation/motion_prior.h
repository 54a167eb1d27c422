#pragma once

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// What is known of a motion apart from the two frames (wheels, an inertial
// sensor, a motion model). A factor of the estimate, not where its solver
// starts, and taken at its word: what the matches scatter by changes nothing
// about it.
struct MotionPrior {
  Rigid3d mean;  // cur_from_prev

  // Inverse of the covariance of [omega (rad), C (m)], as MotionEstimate's. May
  // be singular: an inertial sensor knows rotation alone. Zero, or anything
  // that is no information matrix, means that nothing is known.
  MotionMatrix information = MotionMatrix::Zero();
};

}  // namespace rgbd_pose
