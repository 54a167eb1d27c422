#include "frontend/frame/view_overlap.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {

ViewOverlap::ViewOverlap(const Frame& frame, const Camera& camera, int step_px,
                         double min_depth, double max_depth)
    : camera_(camera) {
  for (int v = step_px / 2; v < frame.depth.rows; v += step_px) {
    for (int u = step_px / 2; u < frame.depth.cols; u += step_px) {
      const double depth = frame.DepthAt(u, v);
      if (depth < min_depth || depth > max_depth) continue;
      const Eigen::Vector3d point =
          camera.Unproject(Eigen::Vector2d(u, v), depth);
      if (point.allFinite()) points_.push_back(point);
    }
  }
}

ViewLikeness ViewOverlap::LikenessTo(const Frame& cur, const cv::Mat& view,
                                     const cv::Mat& level,
                                     const Rigid3d& cur_from_view) const {
  // Relative to depth; more than the noise of any sensor within some metres.
  constexpr double kMaxDepthDifference = 0.05;
  const double scale = static_cast<double>(view.cols) / camera_.width;
  const auto level_at = [&](const cv::Mat& image, const Eigen::Vector2d& at) {
    const auto column = static_cast<int>(at.x() * scale);
    const auto row = static_cast<int>(at.y() * scale);
    return static_cast<double>(image.at<uint8_t>(
        std::min(row, image.rows - 1), std::min(column, image.cols - 1)));
  };
  int seen = 0;
  int agree = 0;
  double a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (const Eigen::Vector3d& sample : points_) {
    const Eigen::Vector3d point = cur_from_view * sample;
    if (!(point.z() > 0.0)) continue;
    const Eigen::Vector2d at = camera_.Project(point);
    if (!camera_.Contains(at)) continue;
    ++seen;
    const double depth = cur.DepthAt(static_cast<int>(at.x() + 0.5),
                                     static_cast<int>(at.y() + 0.5));
    agree += std::abs(depth - point.z()) < kMaxDepthDifference * point.z();
    const double x = level_at(view, camera_.Project(sample));
    const double y = level_at(level, at);
    a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
  }
  if (seen == 0) return {};
  // `+ seen` is the variance of noise of one gray level, which is no contrast.
  const double contrast_a = aa - a * a / seen + seen;
  const double contrast_b = bb - b * b / seen + seen;
  return {(ab - a * b / seen) / std::sqrt(contrast_a * contrast_b),
          static_cast<double>(agree) / seen};
}

Overlap ViewOverlap::SeenFrom(const Rigid3d& cur_from_view) const {
  // Minimum cosine of the angle between the two lines of sight to a point.
  constexpr double kMinCosine = 0.5;
  int seen = 0;
  double flow_px = 0.0, zoom = 0.0;
  const Eigen::Matrix3d R = cur_from_view.rotation.toRotationMatrix();
  // Lens distortion does not matter here.
  const Eigen::Vector2d focal(camera_.fx, camera_.fy);
  const Eigen::Vector2d center(camera_.cx, camera_.cy);
  for (const Eigen::Vector3d& sample : points_) {
    const Eigen::Vector3d ray = R * sample;
    const Eigen::Vector3d point = ray + cur_from_view.translation;
    if (!(point.z() > 0.0)) continue;
    if (point.dot(ray) < kMinCosine * point.norm() * ray.norm()) continue;
    const Eigen::Vector2d pixel =
        focal.cwiseProduct(point.head<2>() / point.z());
    if (!camera_.Contains(pixel + center)) continue;
    ++seen;
    zoom += sample.z() / point.z();
    flow_px +=
        (pixel - focal.cwiseProduct(sample.head<2>() / sample.z())).norm();
  }
  if (seen == 0) return {};
  return {static_cast<double>(seen) / points_.size(), flow_px / seen,
          zoom / seen};
}

}  // namespace rgbd_pose
