#include "frontend/image/image_pyramid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbd_pose {
namespace {

constexpr int kMinSidePx = 8;

}  // namespace

void BuildImagePyramid(const cv::Mat& gray, int levels,
                       std::vector<cv::Mat>* pyramid) {
  pyramid->resize(levels);
  (*pyramid)[0] = gray;
  for (int level = 1; level < levels; ++level) {
    const cv::Mat& finer = (*pyramid)[level - 1];
    const cv::Size half(finer.cols / 2, finer.rows / 2);
    if (std::min(half.width, half.height) < kMinSidePx) {
      pyramid->resize(level);
      return;
    }
    // Of an odd side the last pixel is left out, so that the scale is 2.
    const cv::Mat even = finer(cv::Rect(0, 0, 2 * half.width, 2 * half.height));
    cv::resize(even, (*pyramid)[level], half, 0.0, 0.0, cv::INTER_AREA);
  }
}

}  // namespace rgbd_pose
