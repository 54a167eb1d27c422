#include "frontend/features/grid_selection.h"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <utility>

namespace rgbd_pose {
namespace {

constexpr int kCellPx = 32;
constexpr int kBorderPx = 8;  // a patch needs this border

bool IsStronger(const cv::KeyPoint& a, const cv::KeyPoint& b) {
  if (a.response != b.response) return a.response > b.response;
  // Ties are broken by place, independently of the sort's implementation.
  return std::make_pair(a.pt.y, a.pt.x) < std::make_pair(b.pt.y, b.pt.x);
}

constexpr int kFastThreshold = 12;
constexpr int kWeakFastThreshold = 6;  // for dark or blurred frames

}  // namespace

std::vector<int> SelectOverGrid(
    const std::vector<cv::KeyPoint>& keypoints, const cv::Size& image,
    int max_count, const std::function<bool(const cv::Point2f&)>& accept) {
  const int columns = (image.width + kCellPx - 1) / kCellPx;
  const int rows = (image.height + kCellPx - 1) / kCellPx;
  std::vector<std::vector<int>> cells(columns * rows);
  const cv::Rect2f inside(kBorderPx, kBorderPx, image.width - 2 * kBorderPx,
                          image.height - 2 * kBorderPx);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const cv::Point2f& pixel = keypoints[i].pt;
    if (!inside.contains(pixel)) continue;
    const int cell = static_cast<int>(pixel.y) / kCellPx * columns +
                     static_cast<int>(pixel.x) / kCellPx;
    cells[cell].push_back(static_cast<int>(i));
  }
  // Every second cell is often empty (no texture, no depth). The other cells
  // may therefore provide twice their equal share.
  const size_t share = std::max<size_t>(1, 2 * max_count / cells.size());
  std::vector<int> selected;
  for (std::vector<int>& cell : cells) {
    std::sort(cell.begin(), cell.end(), [&](int a, int b) {
      return IsStronger(keypoints[a], keypoints[b]);
    });
    size_t taken = 0;
    for (size_t i = 0; i < cell.size() && taken < share; ++i) {
      if (!accept(keypoints[cell[i]].pt)) continue;
      selected.push_back(cell[i]);
      ++taken;
    }
  }
  return selected;
}

std::vector<cv::Point2f> DetectGridCorners(
    const cv::Mat& gray, int max_corners,
    const std::function<bool(const cv::Point2f&)>& accept) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(gray, found, kFastThreshold, /*nonmaxSuppression=*/true);
  if (static_cast<int>(found.size()) < 2 * max_corners) {
    cv::FAST(gray, found, kWeakFastThreshold, /*nonmaxSuppression=*/true);
  }
  std::vector<cv::Point2f> corners;
  for (const int i : SelectOverGrid(found, gray.size(), max_corners, accept)) {
    corners.push_back(found[i].pt);
  }
  return corners;
}

}  // namespace rgbd_pose
