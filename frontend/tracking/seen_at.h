#pragma once

#include <optional>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Returns the ideal pixel at which the current camera sees a point observed
// with depth from the reference. The pixel may lie outside the image. Returns
// nothing if the depth is unknown or the point is behind the camera.
inline std::optional<Eigen::Vector2d> SeenAt(const Camera& camera,
                                             const Rigid3d& cur_from_ref,
                                             const Observation& o) {
  if (o.depth <= 0.0) return std::nullopt;
  const Eigen::Vector3d point = cur_from_ref * (camera.Ray(o.u, o.v) * o.depth);
  if (point.z() <= 0.0) return std::nullopt;
  return Eigen::Vector2d(camera.fx * point.x() / point.z() + camera.cx,
                         camera.fy * point.y() / point.z() + camera.cy);
}

}  // namespace rgbd_pose
