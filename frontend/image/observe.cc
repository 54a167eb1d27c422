#include "frontend/image/observe.h"

#include <algorithm>
#include <cmath>

#include "frontend/image/surface_normal.h"

namespace rgbd_pose {
namespace {

// Where depth is not known, what is seen is taken to be so far away (m).
constexpr double kUsualDepth = 2.0;

// The row decides when a point was seen, and that decides the row: one step
// more leaves a hundredth of what the first leaves.
constexpr int kRowSteps = 2;

// Where a point (at the stamp) is seen by rows exposed at such times.
Eigen::Vector2d SeenByRows(const Camera& camera, const Shutter& shutter,
                           const Twist& twist, const Eigen::Vector3d& point,
                           Eigen::Vector3d* moved) {
  Eigen::Vector2d pixel = camera.Project(point);
  *moved = point;
  for (int step = 0; step < kRowSteps; ++step) {
    *moved = twist.MovedPoint(point, shutter.RowTime(pixel.y(), camera.height));
    if (!(moved->z() > 0.0)) return pixel;
    pixel = camera.Project(*moved);
  }
  return pixel;
}

// Depth is looked up where and when it was taken: where that is depends on the
// depth itself.
Observation ObserveMoving(const Frame& frame, const Camera& camera,
                          const FrameTiming& timing, double u, double v,
                          double sigma_px,
                          const DepthLookupOptions& depth_options) {
  constexpr int kDepthSteps = 3;
  const Eigen::Vector2d ideal = camera.Undistort(Eigen::Vector2d(u, v));
  const Eigen::Vector3d ray = camera.Ray(ideal.x(), ideal.y());
  const double seen_at = timing.color.RowTime(v, camera.height);
  const Twist& twist = timing.twist;
  double depth = kUsualDepth;  // when colour was seen
  DepthSample sample;
  Eigen::Vector2d in_depth(u, v);
  Eigen::Vector3d point = twist.MovedPoint(ray * depth, -seen_at);
  for (int step = 0; step < kDepthSteps; ++step) {
    Eigen::Vector3d measured;
    in_depth = SeenByRows(camera, timing.depth, twist, point, &measured);
    sample = LookUpDepth(frame, in_depth.x(), in_depth.y(), depth_options);
    if (sample.depth == 0.0) break;
    depth += sample.depth - measured.z();
    point = twist.MovedPoint(ray * depth, -seen_at);
  }
  Observation seen;
  seen.u = camera.fx * point.x() / point.z() + camera.cx;
  seen.v = camera.fy * point.y() / point.z() + camera.cy;
  seen.sigma_px = sigma_px;
  if (sample.depth == 0.0) return seen;
  seen.depth = point.z();
  seen.sigma_depth = sample.sigma;
  seen.normal = LookUpNormal(frame, camera, in_depth.x(), in_depth.y());
  if (!seen.normal.isZero(0.0)) {
    const double taken_at = timing.depth.RowTime(in_depth.y(), camera.height);
    seen.normal += taken_at * twist.angular.cross(seen.normal);
    seen.normal.normalize();
  }
  return seen;
}

}  // namespace

Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options) {
  const FrameTiming timing = frame.Timing();
  if (!timing.IsOneMoment()) {
    return ObserveMoving(frame, camera, timing, u, v, sigma_px, depth_options);
  }
  const Eigen::Vector2d ideal = camera.Undistort(Eigen::Vector2d(u, v));
  const DepthSample sample = LookUpDepth(frame, u, v, depth_options);
  return {ideal.x(), ideal.y(),    sample.depth,
          sigma_px,  sample.sigma, LookUpNormal(frame, camera, u, v)};
}

Eigen::Vector2d ImagePoint(const Camera& camera, const FrameTiming& timing,
                           const Eigen::Vector3d& point) {
  if (timing.color.IsGlobal()) return camera.Project(point);
  Eigen::Vector3d moved;
  return SeenByRows(camera, timing.color, timing.twist, point, &moved);
}

double LargestFlow(const Camera& camera, const FrameTiming& timing,
                   const Twist& twist) {
  const auto longest = [](const Shutter& shutter) {
    return std::abs(shutter.offset) + 0.5 * std::abs(shutter.readout);
  };
  return std::max(longest(timing.color), longest(timing.depth)) * camera.fx *
         (twist.angular.norm() + twist.linear.norm() / kUsualDepth);
}

}  // namespace rgbd_pose
