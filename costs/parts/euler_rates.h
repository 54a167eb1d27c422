#pragma once

#include <Eigen/Core>

#include "core/geometry/motion.h"

namespace rgbd_pose {

// The rotations omega of the current axes per change of each angle: column k is
// the axis of (dR/d angle_k) R^T.
inline Eigen::Matrix3d EulerRateJacobian(const MotionDerivatives& motion) {
  Eigen::Matrix3d turn;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Matrix3d skew = motion.dR[k] * motion.R.transpose();
    turn.col(k) << skew(2, 1), skew(0, 2), skew(1, 0);
  }
  return turn;
}

}  // namespace rgbd_pose
