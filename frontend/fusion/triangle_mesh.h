#pragma once

#include <Eigen/Core>
#include <vector>

#include "frontend/fusion/colored_point.h"

namespace rgbd_pose {

// A coloured surface.
struct TriangleMesh {
  std::vector<ColoredPoint> vertices;

  // Places in `vertices`, counter-clockwise as seen from where the camera was.
  std::vector<Eigen::Vector3i> triangles;
};

}  // namespace rgbd_pose
