#include "frontend/features/grid_selection.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <tuple>

namespace rgbd_pose {

std::vector<int> SelectOverGrid(const std::vector<cv::KeyPoint>& keypoints,
                                const Frame& frame, int max_count,
                                const DepthLookupOptions& depth_options) {
  constexpr int kBorderPx = 8;  // room for descriptors
  const cv::Size image = frame.gray.size();
  // Larger if there would be more than two cells per feature.
  const int cell_px = std::max(
      32, static_cast<int>(std::ceil(
              std::sqrt(image.area() / 2.0 / std::max(1, max_count)))));
  const int columns = (image.width + cell_px - 1) / cell_px;
  const int rows = (image.height + cell_px - 1) / cell_px;
  // Sorted by strength, the highest first. Ties are broken by place and number,
  // independently of the sort's implementation.
  using Ranked =
      std::tuple<float, float, float, int>;  // -strength, v, u, index
  std::vector<std::vector<Ranked>> cells(columns * rows);
  const cv::Rect2f inside(kBorderPx, kBorderPx, image.width - 2 * kBorderPx,
                          image.height - 2 * kBorderPx);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const cv::Point2f& pixel = keypoints[i].pt;
    if (!inside.contains(pixel)) continue;
    const int cell = static_cast<int>(pixel.y) / cell_px * columns +
                     static_cast<int>(pixel.x) / cell_px;
    cells[cell].emplace_back(-keypoints[i].response, pixel.y, pixel.x,
                             static_cast<int>(i));
  }
  // Every second cell is often empty (no texture, no depth). The other cells
  // may therefore provide twice their equal share.
  const size_t share = std::max<size_t>(1, 2 * max_count / cells.size());
  std::vector<int> selected;
  for (std::vector<Ranked>& cell : cells) {
    std::sort(cell.begin(), cell.end());
    size_t taken = 0;
    for (const auto& [weakness, v, u, i] : cell) {
      if (taken == share) break;
      if (LookUpDepth(frame, u, v, depth_options).depth == 0.0) continue;
      selected.push_back(i);
      ++taken;
    }
  }
  return selected;
}

std::vector<cv::Point2f> DetectGridCorners(
    const Frame& frame, int max_corners,
    const DepthLookupOptions& depth_options) {
  constexpr int kFastThreshold = 12;
  constexpr int kWeakFastThreshold = 6;  // for dark or blurred frames
  std::vector<cv::KeyPoint> found;
  cv::FAST(frame.gray, found, kFastThreshold, /*nonmaxSuppression=*/true);
  if (static_cast<int>(found.size()) < 2 * max_corners) {
    cv::FAST(frame.gray, found, kWeakFastThreshold, /*nonmaxSuppression=*/true);
  }
  std::vector<cv::Point2f> corners;
  for (const int i : SelectOverGrid(found, frame, max_corners, depth_options)) {
    corners.push_back(found[i].pt);
  }
  return corners;
}

}  // namespace rgbd_pose
