#include "frontend/frame/surface_normal.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>

#include "frontend/frame/frame.h"

namespace rgbd_pose {
namespace {

constexpr int kStridePx = 5;

// Deviations from the plane, relative to depth, beyond this are another
// surface: 1.5 % is 5 sigma of a Kinect at 2 m (Khoshelham & Elberink 2012).
constexpr double kMaxDeviation = 0.015;

// Neighbouring pixels on one surface differ by noise and by slope. Noise: 4
// standard deviations of a difference, which has sqrt(2) times that of a depth.
// Slope: a surface seen at 80 degrees, at f = 525 px.
constexpr double kMaxNoiseStep = 4.0 * M_SQRT2;  // of the depth's sigma
constexpr double kMaxSlopeStep = 0.011;          // of the depth

// A pixel with fewer neighbours (of 4) hangs in the air.
constexpr int kMinNeighbours = 2;

}  // namespace

// A plane A X + B Y + C Z = 1 has the inverse depth A x + B y + C over the
// normalised image x = X / Z, y = Y / Z.
Eigen::Vector3d LookUpNormal(const Frame& frame, const Camera& camera, double u,
                             double v, const Eigen::Vector2d& place) {
  const int column = static_cast<int>(std::lround(u));
  const int row = static_cast<int>(std::lround(v));
  if (column < kStridePx || row < kStridePx ||
      column >= frame.depth.cols - kStridePx ||
      row >= frame.depth.rows - kStridePx) {
    return Eigen::Vector3d::Zero();
  }
  double inverse[3][3];
  double mean = 0.0, slope_u = 0.0, slope_v = 0.0;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double depth =
          frame.DepthAt(column + j * kStridePx, row + i * kStridePx);
      if (depth == 0.0) return Eigen::Vector3d::Zero();
      inverse[i + 1][j + 1] = 1.0 / depth;
      mean += inverse[i + 1][j + 1] / 9.0;
      slope_u += j * inverse[i + 1][j + 1] / 6.0;
      slope_v += i * inverse[i + 1][j + 1] / 6.0;
    }
  }
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double plane = mean + j * slope_u + i * slope_v;
      if (std::abs(inverse[i + 1][j + 1] - plane) > kMaxDeviation * mean) {
        return Eigen::Vector3d::Zero();
      }
    }
  }
  const Eigen::Matrix2d pixels = camera.ProjectDerivative(place);
  const Eigen::Vector2d slope =
      pixels.transpose() * Eigen::Vector2d(slope_u, slope_v) / kStridePx;
  const Eigen::Vector2d middle =
      place + pixels.inverse() * Eigen::Vector2d(column - u, row - v);
  const double c = mean - slope.dot(middle);
  return -Eigen::Vector3d(slope.x(), slope.y(), c).normalized();
}

double MaxSurfaceStep(double depth, const DepthNoiseModel& noise) {
  return kMaxNoiseStep * noise.sigma(depth) + kMaxSlopeStep * depth;
}

bool IsOnSurface(const cv::Mat& depth, int x, int y, int max_step) {
  const uint16_t* row = depth.ptr<uint16_t>(y);
  const int raw = row[x];
  int neighbours = 0;
  for (const uint16_t other :
       {row[x - 1], row[x + 1], depth.ptr<uint16_t>(y - 1)[x],
        depth.ptr<uint16_t>(y + 1)[x]}) {
    if (other == 0 || other == Frame::kNoDepth) continue;
    if (std::abs(other - raw) > max_step) return false;
    ++neighbours;
  }
  return neighbours >= kMinNeighbours;
}

}  // namespace rgbd_pose
