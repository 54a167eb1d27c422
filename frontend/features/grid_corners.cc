#include "frontend/features/grid_corners.h"

#include <opencv2/features2d.hpp>

#include "frontend/features/grid_selection.h"

namespace rgbd_pose {
namespace {

constexpr int kFastThreshold = 12;
constexpr int kWeakFastThreshold = 6;  // for dark or blurred frames

}  // namespace

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
