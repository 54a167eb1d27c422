#pragma once

#include "core/geometry/rigid3.h"

// Motions in one direction.

namespace rgbd_pose {

inline Rigid3d Moved(double x, double y, double z) {
  return Rigid3d(Eigen::Quaterniond::Identity(), {x, y, z});
}

// Turned about an axis of unit length by an angle (rad).
inline Rigid3d Turned(double angle, const Eigen::Vector3d& axis) {
  return Rigid3d::FromRotationVector(angle * axis, Eigen::Vector3d::Zero());
}

}  // namespace rgbd_pose
