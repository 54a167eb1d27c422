#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Makes images as a camera without distortion sees them: of the same size,
// focal lengths and principal point. What it sees beyond the image is black,
// without depth.
class Undistorter {
 public:
  explicit Undistorter(const Camera& camera);

  // Colour, grey and depth of a frame; each depth is that of one pixel, never
  // between two surfaces.
  Frame Undistort(const Frame& frame) const;

  // The camera of these frames.
  const Camera& camera() const { return ideal_; }

 private:
  bool has_distortion_;
  Camera ideal_;
  cv::Mat map_x_, map_y_;  // CV_32FC1: where each pixel is in the image
};

}  // namespace rgbd_pose
