#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "frontend/frame/prepared_frame.h"

namespace rgbd_pose {

// An image (CV_8UC1) and `levels - 1` more, each half as wide and high as the
// one before, of the means of 2 x 2 pixels. Level 0 shares the memory of
// `gray`. Fewer levels if the image becomes smaller than 8 pixels.
void BuildImagePyramid(const cv::Mat& gray, int levels,
                       std::vector<cv::Mat>* pyramid);

// The same but for level 0, blurred: for costs that interpolate gray levels,
// which is more exact, and from farther away, where images are smooth.
void BuildSmoothPyramid(const cv::Mat& gray, int levels,
                        std::vector<cv::Mat>* pyramid);

// These of a frame (PreparedFrame::Derived), 640 x 480 to 20 x 15.
struct ImagePyramid {
  explicit ImagePyramid(const PreparedFrame& frame);
  std::vector<cv::Mat> levels;
};
struct SmoothPyramid {
  explicit SmoothPyramid(const PreparedFrame& frame);
  std::vector<cv::Mat> levels;
};

// The camera of the pixels of a level.
Camera CameraOfLevel(const Camera& camera, int level);

// A coordinate (px) of level 0 in another level: the centre of the first 2 x 2
// pixels, at 0.5, becomes 0.
inline float ToLevel(float coordinate, int level) {
  return (coordinate + 0.5F) / static_cast<float>(1 << level) - 0.5F;
}
inline float FromLevel(float coordinate, int level) {
  return (coordinate + 0.5F) * static_cast<float>(1 << level) - 0.5F;
}

}  // namespace rgbd_pose
