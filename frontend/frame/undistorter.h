#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Resamples images to the same camera without distortion. Pixels outside the
// input are black, without depth.
class Undistorter {
 public:
  explicit Undistorter(const Camera& camera);

  // Undistorts all images of a frame. Depth is that of the nearest pixel.
  Frame Undistort(const Frame& frame) const;

  // The camera of the undistorted frames.
  const Camera& camera() const { return ideal_; }

 private:
  Camera ideal_;
  // CV_32FC1: source position of each pixel, px; empty without distortion.
  cv::Mat map_x_, map_y_;
};

}  // namespace rgbd_pose
