#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

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
  // Of all depth pixels, row by row: the ray in the axes of the colour camera
  // (columns 0 to 2) and half the size in the colour image at equal depth, px.
  Eigen::Array<float, Eigen::Dynamic, 5> pixels_;
};

}  // namespace rgbd_pose
