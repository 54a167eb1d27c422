#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rgbd_pose {

// A point of a map with its colour.
struct ColoredPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // m
  std::array<uint8_t, 3> color = {};                   // red, green, blue
};

// A coloured surface.
struct TriangleMesh {
  std::vector<ColoredPoint> vertices;

  // Indices into `vertices`, counter-clockwise as seen from the camera.
  std::vector<Eigen::Vector3i> triangles;
};

}  // namespace rgbd_pose
