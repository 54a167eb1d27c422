#include "frontend/frame/depth_scale.h"

#include <vector>

#include "core/util/format.h"
#include "core/util/quantile.h"

namespace rgbd_pose {

std::string DepthScaleWarning(const Frame& frame) {
  constexpr double kMinPlausible = 0.2;   // m
  constexpr double kMaxPlausible = 20.0;  // m
  std::vector<double> depths;
  depths.reserve(frame.depth.total());
  for (int row = 0; row < frame.depth.rows; ++row) {
    for (int column = 0; column < frame.depth.cols; ++column) {
      const double depth = frame.DepthAt(column, row);
      if (depth > 0.0) depths.push_back(depth);
    }
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
