#pragma once

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "frontend/image/depth_lookup.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {

// The observation of an image point (px, distorted) with a localisation noise
// of sigma_px: undistorted, with the depth and the normal of what is seen
// there, as far as they are known.
Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options);

}  // namespace rgbd_pose
