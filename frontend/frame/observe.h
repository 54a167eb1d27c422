#pragma once

#include <Eigen/Core>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/twist.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The observation of an image point (px, distorted) with a localisation noise
// of sigma_px: undistorted, with the depth and the normal of what is seen
// there, as far as they are known. All as from the camera at the frame's stamp
// (Frame::Timing), whenever row and depth were taken.
Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options);

// The same image point as `before`, which had been moved by another velocity
// (`moved_by`), of a frame whose rows were exposed at different times.
Observation ObserveAgain(const Frame& frame, const Camera& camera,
                         const FrameTiming& moved_by, const Observation& before,
                         const DepthLookupOptions& depth_options);

// The other way round: where a point (m, camera axes at the stamp, z > 0) is
// seen in the image of a frame with such a timing, px, distorted.
Eigen::Vector2d ImagePoint(const Camera& camera, const FrameTiming& timing,
                           const Eigen::Vector3d& point);

// How far (px, about) a velocity moves the most distant row of a frame, of
// something 2 m away: what is lost if nothing is undone.
double LargestFlow(const Camera& camera, const FrameTiming& timing,
                   const Twist& twist);

}  // namespace rgbd_pose
