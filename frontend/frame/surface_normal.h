#pragma once

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Unit normal (camera axes, towards the camera) of the surface seen at an image
// point (px), or zero where there is none: a plane fitted to the inverse depths
// of 3 x 3 pixels several pixels apart, so that the baseline is long against
// the noise of depth. None if a depth is missing or the nine do not lie on one
// plane (an edge between two surfaces). `place`: of the image point on the
// plane z = 1, without distortion.
Eigen::Vector3d LookUpNormal(const Frame& frame, const Camera& camera, double u,
                             double v, const Eigen::Vector2d& place);

}  // namespace rgbd_pose
