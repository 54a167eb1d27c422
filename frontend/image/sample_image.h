#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_pose {

// The grey level of an image (CV_8UC1) at a point between pixels, bilinear. It
// must lie inside: 0 <= u < cols - 1, 0 <= v < rows - 1.
inline float SampleImage(const cv::Mat& image, float u, float v) {
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float s = u - static_cast<float>(column);
  const float t = v - static_cast<float>(row);
  const uint8_t* upper = image.data + image.step * row + column;
  const uint8_t* lower = upper + image.step;
  const float above = upper[0] + s * static_cast<float>(upper[1] - upper[0]);
  const float below = lower[0] + s * static_cast<float>(lower[1] - lower[0]);
  return above + t * (below - above);
}

}  // namespace rgbd_pose
