#include "frontend/sources/repeated_images.h"

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

bool RepeatedImages::IsRepeated(Frame* frame) {
  const bool has_color = !IsTheSame(frame->gray, gray_);
  const bool has_depth = !IsTheSame(frame->depth, depth_);
  gray_ = frame->gray;
  depth_ = frame->depth;
  if (!has_color) {
    ++counts_.color;
    return true;
  }
  if (!has_depth) {
    ++counts_.depth;
    // A new image: an assigned expression would be written into the old one.
    frame->depth = cv::Mat(frame->depth.size(), CV_16UC1, cv::Scalar(0));
  }
  return false;
}

}  // namespace rgbd_pose
