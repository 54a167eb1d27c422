#pragma once

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The error of an estimated motion.
struct MotionError {
  double angle;        // rad
  double translation;  // m
};

inline MotionError ErrorOf(const Rigid3d& estimate, const Rigid3d& truth) {
  const Rigid3d difference = estimate.Inverse() * truth;
  return {difference.Angle(), difference.translation.norm()};
}

}  // namespace rgbd_pose
