#include "frontend/frame/depth_lookup.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// Neighbours further apart than this many sigmas (of a depth difference) lie
// on two surfaces; slanted ones get the slack of kMaxSlope per pixel.
constexpr double kMaxSpreadSigmas = 4.0;

// Relative change of depth from a pixel to the next on the steepest surface
// that is still used: at f = 525 px this is a surface seen at 80 degrees.
constexpr double kMaxSlope = 0.011;

// Fewer valid neighbours (of 9) mean the edge of an object or of a hole.
constexpr int kMinValid = 6;

}  // namespace

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
  const double limit =
      kMaxSpreadSigmas * std::sqrt(2.0) * sigma + 2.0 * kMaxSlope * centre;
  int valid = 0;
  double sum = 0.0, slope_u = 0.0, slope_v = 0.0;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const double depth = frame.DepthAt(column + du, row + dv);
      if (depth == 0.0) continue;
      if (std::abs(depth - centre) > limit) return {};
      const double inverse = 1.0 / depth;
      sum += inverse;
      slope_u += du * inverse;
      slope_v += dv * inverse;
      ++valid;
    }
  }
  if (valid < kMinValid) return {};
  if (valid < 9) return {centre, sigma};
  // Least squares on the full 3 x 3 grid: the mean and sum(x y) / sum(x^2).
  const double inverse =
      sum / 9.0 + slope_u / 6.0 * (u - column) + slope_v / 6.0 * (v - row);
  return {1.0 / inverse, sigma * options.noise.mean_share};
}

}  // namespace rgbd_pose
