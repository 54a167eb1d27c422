#include "apps/calibration/measured_depth.h"

#include <cmath>

#include "frontend/image/depth_plane.h"

namespace rgbd_pose {

MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const CameraVelocity& velocity,
                                const DepthNoiseModel& noise) {
  MeasuredInverseDepth depth;
  if (o.depth <= 0.0) return depth;
  depth.value = 1.0 / o.depth;
  depth.plane = LookUpPlane(frame, camera, pixel.x(), pixel.y(), noise);
  if (depth.plane.isZero(0.0)) return depth;
  depth.ray = camera.Ray(o.u, o.v);
  depth.inverse_sigma = o.depth * o.depth / o.sigma_depth;
  depth.rate_rotation = velocity.rotation;
  depth.rate_translation = velocity.translation;
  const Eigen::Vector2d middle(std::round(pixel.x()), std::round(pixel.y()));
  const double at_middle =
      frame.DepthAt(static_cast<int>(middle.x()), static_cast<int>(middle.y()));
  if (at_middle > 0.0) {
    const Eigen::Vector2d ideal = camera.Undistort(middle);
    depth.pixel_value = 1.0 / at_middle;
    depth.pixel_ray = camera.Ray(ideal.x(), ideal.y());
  }
  return depth;
}

}  // namespace rgbd_pose
