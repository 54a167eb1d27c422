#include "frontend/frame/depth_lookup.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "core/estimation/inverse_depth_plane.h"
#include "core/util/format.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// Neighbours that differ by more sigmas of a depth are on two surfaces: 4
// sigmas of a difference. For slanted surfaces kMaxSlope per pixel is added.
constexpr double kMaxNoiseStep = 4.0 * M_SQRT2;

// Relative change of depth from one pixel to the next on the steepest surface
// used. With f = 525 px this is a surface seen at 80 degrees.
constexpr double kMaxSlope = 0.011;

// With fewer of nine depths a whole side may be missing, as where one object
// hides another: a plane would be extrapolated.
constexpr int kMinOfPlane = 7;

}  // namespace

std::string DepthLookupOptions::Check() const {
  const std::string noise_error = noise.Check();
  if (!noise_error.empty()) return "depth noise: " + noise_error;
  constexpr double kMost = 1000.0;  // m
  if (!(min_depth > 0.0 && max_depth > min_depth && max_depth <= kMost)) {
    return "depth limits must satisfy 0 < min_depth < max_depth <= 1000 m";
  }
  return "";
}

DepthSample LookUpDepth(const Frame& frame, double u, double v,
                        const DepthLookupOptions& options) {
  const int column = static_cast<int>(std::lround(u));
  const int row = static_cast<int>(std::lround(v));
  if (column < 1 || row < 1 || column >= frame.depth.cols - 1 ||
      row >= frame.depth.rows - 1) {
    return {};
  }
  const double centre = frame.DepthAt(column, row);
  if (centre < options.min_depth || centre > options.max_depth) return {};

  const double sigma = options.noise.sigma(centre);
  const double limit = kMaxNoiseStep * sigma + 2.0 * kMaxSlope * centre;
  InverseDepthGrid<3> grid;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const double depth = frame.DepthAt(column + du, row + dv);
      if (depth == 0.0) continue;
      if (std::abs(depth - centre) > limit) return {};
      grid.Add(du, dv, 1.0 / depth);
    }
  }
  // Fewer mean the edge of an object or of a hole.
  constexpr int kMinDepths = 6;
  if (grid.count() < kMinDepths) return {};
  const std::optional<InverseDepthPlane> plane = grid.Fit(kMinOfPlane);
  if (!plane.has_value()) return {centre, sigma};
  return {1.0 / plane->At(u - column, v - row),
          sigma * options.noise.mean_share * plane->relative_sigma};
}

// A plane A X + B Y + C Z = 1 has the inverse depth A x + B y + C over the
// normalised image x = X / Z, y = Y / Z.
Eigen::Vector3d LookUpNormal(const Frame& frame, const Camera& camera, double u,
                             double v, const Eigen::Vector2d& place) {
  constexpr int kStridePx = 5;  // distance of the pixels used
  // A point with a larger relative deviation from the plane is on another
  // surface. 1.5 % is 5 sigma of a Kinect at 2 m (Khoshelham & Elberink 2012).
  constexpr double kMaxDeviation = 0.015;
  const int column = static_cast<int>(std::lround(u));
  const int row = static_cast<int>(std::lround(v));
  if (column < kStridePx || row < kStridePx ||
      column >= frame.depth.cols - kStridePx ||
      row >= frame.depth.rows - kStridePx) {
    return Eigen::Vector3d::Zero();
  }
  double inverse[3][3];  // 0: unknown
  InverseDepthGrid<3> grid;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double depth =
          frame.DepthAt(column + j * kStridePx, row + i * kStridePx);
      inverse[i + 1][j + 1] = depth > 0.0 ? 1.0 / depth : 0.0;
      if (depth > 0.0) grid.Add(j, i, 1.0 / depth);
    }
  }
  const std::optional<InverseDepthPlane> plane = grid.Fit(kMinOfPlane);
  if (!plane.has_value()) return Eigen::Vector3d::Zero();
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double seen = inverse[i + 1][j + 1];
      if (seen > 0.0 &&
          std::abs(seen - plane->At(j, i)) > kMaxDeviation * plane->middle) {
        return Eigen::Vector3d::Zero();
      }
    }
  }
  const Eigen::Matrix2d pixels = camera.ProjectDerivative(place);
  const Eigen::Vector2d slope = pixels.transpose() * plane->slope / kStridePx;
  const Eigen::Vector2d middle =
      place + pixels.inverse() * Eigen::Vector2d(column - u, row - v);
  const double c = plane->middle - slope.dot(middle);
  return -Eigen::Vector3d(slope.x(), slope.y(), c).normalized();
}

double MaxSurfaceStep(double depth, const DepthNoiseModel& noise) {
  return kMaxNoiseStep * noise.sigma(depth) + kMaxSlope * depth;
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
  return neighbours >= 2;
}

std::string DepthScaleWarning(const Frame& frame) {
  const double kMinPlausible = DepthLookupOptions().min_depth;
  constexpr double kMaxPlausible = 20.0;  // m
  std::vector<double> depths;
  depths.reserve(frame.depth.total());
  for (const uint16_t raw : cv::Mat_<uint16_t>(frame.depth)) {
    if (raw == 0 || raw == Frame::kNoDepth) continue;
    depths.push_back(raw / frame.depth_scale);
  }
  if (depths.empty()) return "";
  const double median = UpperMedian(&depths);
  if (median >= kMinPlausible && median <= kMaxPlausible) return "";
  return Format(
      "frame %d: the median depth is %.3g m; check the depth scale (%.6g raw "
      "units per metre)",
      frame.index, median, frame.depth_scale);
}

}  // namespace rgbd_pose
