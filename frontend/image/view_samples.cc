#include "frontend/image/view_samples.h"

namespace rgbd_pose {
namespace {

// Of the angle between two lines of sight to one point.
constexpr double kMinCosine = 0.5;

}  // namespace

ViewSamples::ViewSamples(const Frame& frame, const Camera& camera, int step_px,
                         double min_depth, double max_depth)
    : camera_(camera) {
  for (int v = step_px / 2; v < frame.depth.rows; v += step_px) {
    for (int u = step_px / 2; u < frame.depth.cols; u += step_px) {
      const double depth = frame.DepthAt(u, v);
      if (depth < min_depth || depth > max_depth) continue;
      points_.push_back(camera.Unproject(Eigen::Vector2d(u, v), depth));
    }
  }
}

Overlap ViewSamples::SeenFrom(const Rigid3d& cur_from_view) const {
  Overlap overlap;
  int seen = 0;
  double zoom = 0.0;
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
    overlap.flow_px +=
        (pixel - focal.cwiseProduct(sample.head<2>() / sample.z())).norm();
  }
  if (seen == 0) return overlap;
  overlap.share = static_cast<double>(seen) / points_.size();
  overlap.flow_px /= seen;
  overlap.zoom = zoom / seen;
  return overlap;
}

}  // namespace rgbd_pose
