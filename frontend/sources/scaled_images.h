#pragma once

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// Phones store colour and depth of the same camera in different sizes.

// The camera of the same image, scaled to a size; without distortion.
inline Camera ScaledTo(const Camera& camera, const cv::Size& size) {
  const double x = static_cast<double>(size.width) / camera.width;
  const double y = static_cast<double>(size.height) / camera.height;
  return {size.width,
          size.height,
          camera.fx * x,
          camera.fy * y,
          (camera.cx + 0.5) * x - 0.5,
          (camera.cy + 0.5) * y - 0.5};
}

// The affine map from pixels of `from` to those of `to`, at the same pose.
inline cv::Matx23d PixelMap(const Camera& from, const Camera& to) {
  const double x = to.fx / from.fx;
  const double y = to.fy / from.fy;
  return {x, 0.0, to.cx - x * from.cx, 0.0, y, to.cy - y * from.cy};
}

}  // namespace rgbd_pose
