#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "frontend/frame/prepared_frame.h"

namespace rgbd_pose {

// Builds an image pyramid: the image (CV_8UC1) and `levels - 1` more, each half
// as wide and high as the one before, with the means of 2 x 2 pixels. Level 0
// shares the memory of `gray`. Levels with a side below 8 pixels are left out.
void BuildImagePyramid(const cv::Mat& gray, int levels,
                       std::vector<cv::Mat>* pyramid);

// The same with all levels but level 0 blurred. For costs that interpolate gray
// levels: in smooth images interpolation is more accurate, and the costs
// converge from farther away.
void BuildSmoothPyramid(const cv::Mat& gray, int levels,
                        std::vector<cv::Mat>* pyramid);

// The pyramids of a frame (PreparedFrame::Derived), 640 x 480 to 20 x 15.
struct ImagePyramid {
  explicit ImagePyramid(const PreparedFrame& frame);
  std::vector<cv::Mat> levels;
};
struct SmoothPyramid {
  explicit SmoothPyramid(const PreparedFrame& frame);
  std::vector<cv::Mat> levels;
};

// The camera of a pyramid level.
Camera CameraOfLevel(const Camera& camera, int level);

// Convert a coordinate (px) from level 0 to another level and back. The centre
// of the first 2 x 2 pixels, at 0.5, becomes 0 in level 1.
inline float ToLevel(float coordinate, int level) {
  return (coordinate + 0.5F) / static_cast<float>(1 << level) - 0.5F;
}
inline float FromLevel(float coordinate, int level) {
  return (coordinate + 0.5F) * static_cast<float>(1 << level) - 0.5F;
}

}  // namespace rgbd_pose
