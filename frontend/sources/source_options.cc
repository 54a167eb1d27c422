#include "frontend/sources/source_options.h"

#include <cmath>

namespace rgbd_pose {

std::string SourceOptions::Check() const {
  const std::string problem = camera.camera.Check();
  if (!problem.empty()) return "camera: " + problem;
  if (!(std::isfinite(camera.depth_scale) && camera.depth_scale > 0.0)) {
    return "the depth scale must be a positive number";
  }
  if (!(max_time_difference >= 0.0)) {
    return "the time difference must not be negative";
  }
  return "";
}

}  // namespace rgbd_pose
