#include "frontend/grid_corners.h"

#include <algorithm>
#include <opencv2/features2d.hpp>

namespace rgbd_pose {
namespace {

constexpr int kCellPx = 32;
constexpr int kFastThreshold = 12;
constexpr int kWeakFastThreshold = 6;  // for dark or blurred frames
constexpr int kBorderPx = 8;           // no patch around it otherwise

bool IsStronger(const cv::KeyPoint& a, const cv::KeyPoint& b) {
  if (a.response != b.response) return a.response > b.response;
  // Ties by place keep the order independent of the sort's implementation.
  return std::make_pair(a.pt.y, a.pt.x) < std::make_pair(b.pt.y, b.pt.x);
}

}  // namespace

std::vector<cv::Point2f> DetectGridCorners(
    const cv::Mat& gray, int max_corners,
    const std::function<bool(const cv::Point2f&)>& accept) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(gray, found, kFastThreshold, /*nonmaxSuppression=*/true);
  if (static_cast<int>(found.size()) < 2 * max_corners) {
    cv::FAST(gray, found, kWeakFastThreshold, /*nonmaxSuppression=*/true);
  }
  const int columns = (gray.cols + kCellPx - 1) / kCellPx;
  const int rows = (gray.rows + kCellPx - 1) / kCellPx;
  std::vector<std::vector<cv::KeyPoint>> cells(columns * rows);
  const cv::Rect2f inside(kBorderPx, kBorderPx, gray.cols - 2 * kBorderPx,
                          gray.rows - 2 * kBorderPx);
  for (const cv::KeyPoint& corner : found) {
    if (!inside.contains(corner.pt)) continue;
    const int cell = static_cast<int>(corner.pt.y) / kCellPx * columns +
                     static_cast<int>(corner.pt.x) / kCellPx;
    cells[cell].push_back(corner);
  }
  // Every second cell is often empty (no texture, no depth): let the others
  // give twice their fair share.
  const size_t share = std::max<size_t>(1, 2 * max_corners / cells.size());
  std::vector<cv::Point2f> corners;
  for (std::vector<cv::KeyPoint>& cell : cells) {
    std::sort(cell.begin(), cell.end(), IsStronger);
    size_t taken = 0;
    for (size_t i = 0; i < cell.size() && taken < share; ++i) {
      if (!accept(cell[i].pt)) continue;
      corners.push_back(cell[i].pt);
      ++taken;
    }
  }
  return corners;
}

}  // namespace rgbd_pose
