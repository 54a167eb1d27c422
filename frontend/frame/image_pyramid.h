#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/estimation/frame_view.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/frame/prepared_frame.h"

namespace rgbd_pose {

// The image pyramid of a frame (PreparedFrame::Derived), 640 x 480 to 20 x 15.
// Level 0 shares the memory of the image (CV_8UC1); each further level has the
// means of 2 x 2 pixels. Levels with a side below 8 pixels are left out.
struct ImagePyramid {
  explicit ImagePyramid(const PreparedFrame& frame);  // computes all levels
  std::vector<cv::Mat> levels;                        // full resolution first
};

// The same with all levels but level 0 blurred: for costs, which interpolate
// smooth images more accurately and converge from farther away.
struct SmoothPyramid {
  explicit SmoothPyramid(const PreparedFrame& frame);  // computes all levels
  std::vector<cv::Mat> levels;                         // full resolution first
};

// A view of a frame for direct costs. All images are shared and must outlive
// it. `pyramid`: of frame.gray; `camera`: of level 0.
FrameView ViewFrame(const Frame& frame, const std::vector<cv::Mat>& pyramid,
                    const Camera& camera, const DepthNoiseModel& depth_noise);

// The camera of a pyramid level.
Camera CameraOfLevel(const Camera& camera, int level);

// Converts a coordinate (px) from level 0 to another level. The centre of the
// first 2 x 2 pixels, at 0.5, becomes 0 in level 1.
inline float ToLevel(float coordinate, int level) {
  return (coordinate + 0.5F) / static_cast<float>(1 << level) - 0.5F;
}
// The inverse.
inline float FromLevel(float coordinate, int level) {
  return (coordinate + 0.5F) * static_cast<float>(1 << level) - 0.5F;
}

}  // namespace rgbd_pose
