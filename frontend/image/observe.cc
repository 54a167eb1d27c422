#include "frontend/image/observe.h"

#include "frontend/image/surface_normal.h"

namespace rgbd_pose {

Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options) {
  const Eigen::Vector2d ideal = camera.Undistort(Eigen::Vector2d(u, v));
  const DepthSample sample = LookUpDepth(frame, u, v, depth_options);
  return {ideal.x(), ideal.y(),    sample.depth,
          sigma_px,  sample.sigma, LookUpNormal(frame, camera, u, v)};
}

}  // namespace rgbd_pose
