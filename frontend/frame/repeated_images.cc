#include "frontend/frame/repeated_images.h"

#include <cstring>

namespace rgbd_pose {
namespace {

// Whether an image shows something and is the same as another one.
bool IsTheSame(const cv::Mat& image, const cv::Mat& before) {
  if (image.size() != before.size() || image.type() != before.type()) {
    return false;
  }
  const size_t bytes = image.cols * image.elemSize();
  for (int row = 0; row < image.rows; ++row) {
    if (std::memcmp(image.ptr(row), before.ptr(row), bytes) != 0) return false;
  }
  double least = 0.0, most = 0.0;
  cv::minMaxLoc(image, &least, &most);
  return least < most;
}

}  // namespace

bool RepeatedImages::IsRepeated(const Frame& frame) {
  const bool is_old_color = IsTheSame(frame.gray, gray_);
  const bool is_old_depth = IsTheSame(frame.depth, depth_);
  counts_.color += is_old_color;
  counts_.depth += is_old_depth;
  gray_ = frame.gray;
  depth_ = frame.depth;
  return is_old_color || is_old_depth;
}

}  // namespace rgbd_pose
