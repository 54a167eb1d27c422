#pragma once

#include <Eigen/Core>

#include "core/estimation/correspondences.h"

namespace rgbd_pose {

// The ray (a, b, 1) of an observation in camera axes: its point is depth times
// as far.
inline Eigen::Vector3d Ray(const Camera& camera, const Observation& o) {
  return {(o.u - camera.cx) / camera.fx, (o.v - camera.cy) / camera.fy, 1.0};
}

}  // namespace rgbd_pose
