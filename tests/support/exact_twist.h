#pragma once

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// later_from_earlier of a camera at constant accelerations, composed of short
// motions, whose translations lack second-order terms: 200 steps are accurate
// to about 1e-6 m in a readout.
inline Rigid3d ExactMotion(const Twist& twist, double seconds,
                           int steps = 200) {
  const double step = seconds / steps;
  Rigid3d motion;
  for (int i = 0; i < steps; ++i) {
    motion = twist.After(i * step).MotionDuring(step) * motion;
  }
  return motion;
}

// The pixel at which a rolling shutter sees a point (camera axes at the stamp,
// m), by bisection of the row.
inline Eigen::Vector2d ExactlySeen(const Camera& camera, const Shutter& shutter,
                                   const Twist& twist,
                                   const Eigen::Vector3d& point) {
  const auto seen_from = [&](double row) {
    const double seconds = shutter.RowTime(row, camera.height);
    return camera.Project(ExactMotion(twist, seconds) * point);
  };
  constexpr int kBisections = 30;
  double above = -camera.height;
  double below = 2.0 * camera.height;
  for (int i = 0; i < kBisections; ++i) {
    const double row = 0.5 * (above + below);
    (seen_from(row).y() > row ? above : below) = row;
  }
  return seen_from(above);
}

}  // namespace rgbd_pose
