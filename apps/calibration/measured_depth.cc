#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "apps/calibration/displaced_depths.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {
namespace {

constexpr int kReach = 3;  // pixels of the grid to each side
constexpr int kWindowSide = 2 * kReach + 1;

// The spread of a plane's pixels: so many sigmas, or this share of the depth,
// which lets a bulge pass.
constexpr double kMaxSigmas = 3.0;
constexpr double kMaxBulge = 0.01;

// So many of the 49 must be there and lie on it.
constexpr int kMinOnPlane = 44;

// The surface seen around an image point (px, distorted) as a plane m . X = z,
// where X is on it and z its depth at the point: so m . r = 1 for the ray
// r = (a, b, 1) there. Zero where there is no plane. Fitted to the inverse
// depths of 49 pixels, of a VGA image up to 6 px away: the slope of fewer or
// nearer ones is mostly noise.
Eigen::Vector3d LookUpPlane(const Frame& frame, const Camera& camera, double u,
                            double v, const DepthNoiseModel& noise) {
  const int column = static_cast<int>(std::lround(u));
  const int row = static_cast<int>(std::lround(v));
  // As far apart as 2 px of a VGA image.
  const int stride = std::max(1, frame.depth.cols / 320);
  const int border = kReach * stride;
  if (column < border || row < border || column >= frame.depth.cols - border ||
      row >= frame.depth.rows - border) {
    return Eigen::Vector3d::Zero();
  }
  double inverse[kWindowSide][kWindowSide];
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int count = 0;
  for (int i = 0; i < kWindowSide; ++i) {
    for (int j = 0; j < kWindowSide; ++j) {
      const double depth = frame.DepthAt(column + (j - kReach) * stride,
                                         row + (i - kReach) * stride);
      inverse[i][j] = depth > 0.0 ? 1.0 / depth : 0.0;
      if (depth == 0.0) continue;
      const Eigen::Vector3d at(j - kReach, i - kReach, 1.0);
      normal += at * at.transpose();
      right += at * inverse[i][j];
      ++count;
    }
  }
  if (count < kMinOnPlane) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  const double middle = fit[2];
  if (!(middle > 0.0)) return Eigen::Vector3d::Zero();
  // d(1/z) = dz / z^2.
  const double limit =
      std::max(kMaxSigmas * noise.sigma(1.0 / middle) * middle * middle,
               kMaxBulge * middle);
  for (int i = 0; i < kWindowSide; ++i) {
    for (int j = 0; j < kWindowSide; ++j) {
      if (inverse[i][j] == 0.0) continue;
      const double plane = fit.dot(Eigen::Vector3d(j - kReach, i - kReach, 1));
      if (std::abs(inverse[i][j] - plane) > limit) --count;
    }
  }
  if (count < kMinOnPlane) return Eigen::Vector3d::Zero();
  const Eigen::Vector2d ideal = camera.Undistort({u, v});
  const Eigen::Vector3d ray = camera.Ray(ideal.x(), ideal.y());
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  plane.head<2>() = camera.ProjectDerivative(ray.head<2>()).transpose() *
                    fit.head<2>() / (stride * middle);
  plane.z() = 1.0 - plane.x() * ray.x() - plane.y() * ray.y();
  return plane;
}

}  // namespace

MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const DepthNoiseModel& noise) {
  MeasuredInverseDepth depth;
  if (o.depth <= 0.0) return depth;
  depth.value = 1.0 / o.depth;
  depth.plane = LookUpPlane(frame, camera, pixel.x(), pixel.y(), noise);
  if (depth.plane.isZero(0.0)) return depth;
  depth.ray = camera.Ray(o.u, o.v);
  depth.inverse_sigma = o.depth * o.depth / o.sigma_depth;
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
