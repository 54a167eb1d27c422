#include "frontend/image/depth_scale.h"

#include <algorithm>
#include <cstdio>
#include <vector>

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
  const auto middle = depths.begin() + depths.size() / 2;
  std::nth_element(depths.begin(), middle, depths.end());
  if (*middle >= kMinPlausible && *middle <= kMaxPlausible) return "";
  char text[200];
  std::snprintf(text, sizeof(text),
                "frame %d: the median depth is %.3g m; check the depth scale "
                "(%.6g raw units per metre)",
                frame.index, *middle, frame.depth_scale);
  return text;
}

}  // namespace rgbd_pose
