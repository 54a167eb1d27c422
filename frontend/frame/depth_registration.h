#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The camera of the depth images, if it is not the colour camera.
struct DepthCamera {
  Camera camera;             // of the depth image
  Rigid3d color_from_depth;  // pose of the depth camera in the colour camera
};

// Registers depth images to the colour camera. Each depth pixel becomes the
// rectangle that it covers in the colour image, with its new depth. If several
// fall on one pixel, the nearest hides the others. Surfaces that the depth
// camera does not see have no depth.
class DepthRegistration {
 public:
  // Throws InputError for invalid cameras.
  DepthRegistration(const DepthCamera& depth, const Camera& color);

  // `depth`: CV_16UC1 of the depth camera's size; 0 and Frame::kNoDepth: none.
  // The result has the colour camera's size and the same units. Thread-safe.
  cv::Mat Register(const cv::Mat& depth, double units_per_metre) const;

 private:
  void RegisterRow(const uint16_t* depth, int row, double units_per_metre,
                   cv::Mat* registered) const;

  Camera color_;
  Eigen::Vector3f translation_;  // of color_from_depth, m
  int width_;
  int height_;
  // Rays of all depth pixels in the axes of the colour camera, row by row.
  std::vector<float> ray_x_, ray_y_, ray_z_;
  // Half the sizes of the depth pixels in the colour image at equal depth, px.
  std::vector<float> half_width_, half_height_;
};

}  // namespace rgbd_pose
