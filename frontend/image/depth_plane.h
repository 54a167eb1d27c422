#pragma once

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {

// The surface seen around an image point (px, distorted) as a plane m . X = z,
// where X is on it and z its depth at the point: so m . r = 1 for the ray
// r = (a, b, 1) there. Zero where there is no plane. Fitted to the inverse
// depths of 49 pixels, of a VGA image up to 6 px away: the slope of fewer or
// nearer ones is mostly noise.
Eigen::Vector3d LookUpPlane(const Frame& frame, const Camera& camera, double u,
                            double v, const DepthNoiseModel& noise);

}  // namespace rgbd_pose
