#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace rgbd_pose {

// A point of a map: metres, and its colour.
struct ColoredPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // m

  // Its colour.
  uint8_t red = 0;
  uint8_t green = 0;
  uint8_t blue = 0;
};

}  // namespace rgbd_pose
