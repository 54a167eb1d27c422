#include "frontend/image/depth_plane.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

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

}  // namespace

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
  Eigen::Vector3d plane(fit[0] / stride * camera.fx / middle,
                        fit[1] / stride * camera.fy / middle, 0.0);
  plane.z() = 1.0 - plane.x() * ray.x() - plane.y() * ray.y();
  return plane;
}

}  // namespace rgbd_pose
