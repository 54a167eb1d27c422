#include "frontend/frame/observe.h"

#include <algorithm>
#include <cmath>

#include "frontend/frame/depth_warper.h"

namespace rgbd_pose {
namespace {

// Depth assumed for a point without a known depth, m.
constexpr double kUsualDepth = 1.0 / kRoomInverseDepth;

// The image point of a point (at the stamp) with this shutter. `row` is a first
// guess. `moved` is the point in camera axes at the exposure time of its row.
Eigen::Vector2d SeenByRows(const Camera& camera, const Shutter& shutter,
                           const Twist& twist, const Eigen::Vector3d& point,
                           double row, Eigen::Vector3d* moved) {
  // The time depends on the row where the point is seen, and the row on the
  // time. The second iteration reduces the remaining error to a hundredth. It
  // is not needed if the row is as guessed.
  constexpr double kSameRow = 0.05;  // px: a few microseconds
  Eigen::Vector2d pixel;
  for (int step = 0; step < 2; ++step) {
    *moved = twist.MovedPoint(point, shutter.RowTime(row, camera.height));
    if (!(moved->z() > 0.0)) return step > 0 ? pixel : camera.Project(point);
    pixel = camera.Project(*moved);
    if (std::abs(pixel.y() - row) < kSameRow) break;
    row = pixel.y();
  }
  return pixel;
}

// The observation along a ray (a, b, 1) that was seen `seconds` after the
// stamp, in `row`. Depth is looked up at the position and time of its exposure.
// This depends on the depth itself: it is iterated from the guess `depth`.
Observation ObserveMoving(const Frame& frame, const Camera& camera,
                          const FrameTiming& timing, const Eigen::Vector3d& ray,
                          double row, double depth, double sigma_px,
                          const DepthLookupOptions& depth_options) {
  constexpr double kSmallChange = 0.01;  // relative depth: a tenth of a pixel
  constexpr int kDepthSteps = 3;
  const Twist& twist = timing.twist;
  const double seconds = timing.color.RowTime(row, camera.height);
  const Twist mean = twist.Mean(seconds);
  const auto at_stamp = [&](double depth_of_row) {
    return mean.MovedPoint(ray * depth_of_row, -seconds);
  };
  DepthSample sample;
  Eigen::Vector2d in_depth(0.0, row), in_depth_place;
  Eigen::Vector3d point = at_stamp(depth);
  for (int step = 0; step < kDepthSteps; ++step) {
    Eigen::Vector3d measured;
    in_depth =
        SeenByRows(camera, timing.depth, twist, point, in_depth.y(), &measured);
    in_depth_place = measured.head<2>() / measured.z();
    sample = LookUpDepth(frame, in_depth.x(), in_depth.y(), depth_options);
    if (sample.depth == 0.0) break;
    const double change = sample.depth - measured.z();
    depth += change;
    point = at_stamp(depth);
    if (std::abs(change) < kSmallChange * depth) break;
  }
  Observation seen;
  seen.u = camera.fx * point.x() / point.z() + camera.cx;
  seen.v = camera.fy * point.y() / point.z() + camera.cy;
  seen.sigma_px = sigma_px;
  if (sample.depth == 0.0) return seen;
  seen.depth = point.z();
  seen.sigma_depth = sample.sigma;
  seen.normal =
      LookUpNormal(frame, camera, in_depth.x(), in_depth.y(), in_depth_place);
  if (!seen.normal.isZero(0.0)) {
    const double taken_at = timing.depth.RowTime(in_depth.y(), camera.height);
    seen.normal += taken_at * twist.Mean(taken_at).angular.cross(seen.normal);
    seen.normal.normalize();
  }
  return seen;
}

}  // namespace

Observation Observe(const Frame& frame, const Camera& camera, double u,
                    double v, double sigma_px,
                    const DepthLookupOptions& depth_options) {
  const FrameTiming timing = frame.Timing();
  const Eigen::Vector2d ideal = camera.Undistort(Eigen::Vector2d(u, v));
  // If the lens gives no ray, nothing is known, not even a depth.
  if (!ideal.allFinite()) return {ideal.x(), ideal.y(), 0.0, sigma_px};
  const Eigen::Vector3d ray = camera.Ray(ideal.x(), ideal.y());
  if (!timing.IsOneMoment()) {
    return ObserveMoving(frame, camera, timing, ray, v, kUsualDepth, sigma_px,
                         depth_options);
  }
  const DepthSample sample = LookUpDepth(frame, u, v, depth_options);
  const Eigen::Vector3d normal =
      LookUpNormal(frame, camera, u, v, ray.head<2>());
  return {ideal.x(), ideal.y(), sample.depth, sigma_px, sample.sigma, normal};
}

Observation ObserveAgain(const Frame& frame, const Camera& camera,
                         const FrameTiming& moved_by, const Observation& before,
                         const DepthLookupOptions& depth_options) {
  const double depth = before.depth > 0.0 ? before.depth : kUsualDepth;
  Eigen::Vector3d seen;
  const Eigen::Vector2d pixel =
      SeenByRows(camera, moved_by.color, moved_by.twist,
                 camera.Ray(before.u, before.v) * depth, before.v, &seen);
  return ObserveMoving(frame, camera, frame.Timing(), seen / seen.z(),
                       pixel.y(), seen.z(), before.sigma_px, depth_options);
}

Observation MovedObservation(const Observation& seen, const Camera& camera,
                             const Rigid3d& other_from_camera) {
  const double depth = seen.depth > 0.0 ? seen.depth : kUsualDepth;
  const Eigen::Vector3d point =
      other_from_camera * (camera.Ray(seen.u, seen.v) * depth);
  Observation moved = seen;
  moved.u = camera.fx * point.x() / point.z() + camera.cx;
  moved.v = camera.fy * point.y() / point.z() + camera.cy;
  if (seen.depth > 0.0) moved.depth = point.z();
  moved.normal = other_from_camera.rotation * seen.normal;
  return moved;
}

Eigen::Vector2d ImagePoint(const Camera& camera, const FrameTiming& timing,
                           const Eigen::Vector3d& point) {
  if (timing.color.IsGlobal()) return camera.Project(point);
  Eigen::Vector3d moved;
  return SeenByRows(camera, timing.color, timing.twist, point,
                    camera.Project(point).y(), &moved);
}

double LargestFlow(const Camera& camera, const FrameTiming& timing,
                   const Twist& twist) {
  const auto longest = [](const Shutter& shutter) {
    return std::abs(shutter.offset) + 0.5 * std::abs(shutter.readout);
  };
  return std::max(longest(timing.color), longest(timing.depth)) * camera.fx *
         (twist.angular.norm() + twist.linear.norm() / kUsualDepth +
          0.5 * std::max(longest(timing.color), longest(timing.depth)) *
              (twist.angular_acceleration.norm() +
               twist.linear_acceleration.norm() / kUsualDepth));
}

}  // namespace rgbd_pose
