#pragma once

#include <Eigen/Core>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The observation of an image point (px, distorted) with a localisation noise
// of sigma_px: undistorted, with the depth and normal of the surface if known.
// All values are converted from the exposure times of the row and of depth to
// the camera at the stamp of the frame (Frame::Timing).
Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options);

// The observation of the same image point as `before`, which was made with
// another velocity (`moved_by`), for a frame with a rolling shutter.
Observation ObserveAgain(const Frame& frame, const Camera& camera,
                         const FrameTiming& moved_by, const Observation& before,
                         const DepthLookupOptions& depth_options);

// The observation in the axes of another camera nearby, which stands still.
Observation MovedObservation(const Observation& seen, const Camera& camera,
                             const Rigid3d& other_from_camera);

// The inverse: the image point (px, distorted) of a 3D point (m, camera axes at
// the stamp, z > 0) in a frame with this timing.
Eigen::Vector2d ImagePoint(const Camera& camera, const FrameTiming& timing,
                           const Eigen::Vector3d& point);

// The approximate motion (px) that a velocity causes in the row farthest from
// the stamp, for a point 2 m away: the error if nothing is corrected.
double LargestFlow(const Camera& camera, const FrameTiming& timing,
                   const Twist& twist);

}  // namespace rgbd_pose
