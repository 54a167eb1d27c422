#pragma once

#include "core/camera.h"
#include "core/correspondences.h"
#include "frontend/depth_lookup.h"
#include "frontend/frame.h"

namespace rgbd_pose {

// The observation of an image point (px, distorted) with a localisation noise
// of sigma_px: undistorted, with the depth and the normal of what is seen
// there, as far as they are known.
Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options);

}  // namespace rgbd_pose
