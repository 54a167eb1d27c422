#pragma once

#include <Eigen/Core>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "costs/calibration/landmark_residuals.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// What an observation at `pixel` (as seen, distorted) says of depth. Nothing
// where the surface is no plane.
MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const DepthNoiseModel& noise);

}  // namespace rgbd_pose
