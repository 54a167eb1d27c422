#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The camera that took the depth images, where it is not the colour camera.
struct DepthCamera {
  Camera camera;             // of the depth image
  Rigid3d color_from_depth;  // from its axes into those of the colour camera
};

// Depth images as the colour camera would have taken them. Each depth pixel
// becomes the rectangle that it covers there, at its new distance; where
// several fall on one pixel, the nearest hides the others. What the depth
// camera does not see stays without depth.
class DepthRegistration {
 public:
  // Throws InputError for cameras that make no sense.
  DepthRegistration(const DepthCamera& depth, const Camera& color);

  // `depth`: CV_16UC1 of the depth camera's size; 0 and Frame::kNoDepth: none.
  // Returns one of the colour camera's size in the same units. From any thread.
  cv::Mat Register(const cv::Mat& depth, double units_per_metre) const;

 private:
  void RegisterRow(const uint16_t* depth, int row, double units_per_metre,
                   cv::Mat* registered) const;

  Camera color_;
  Eigen::Vector3f translation_;  // of color_from_depth, m
  int width_;
  int height_;
  // The rays of all depth pixels in the colour camera's axes, row by row.
  std::vector<float> ray_x_, ray_y_, ray_z_;
  // Half their sizes in the colour image at the same distance, px.
  std::vector<float> half_width_, half_height_;
};

}  // namespace rgbd_pose
