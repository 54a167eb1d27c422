#include "core/geometry/depth_noise.h"

#include <cmath>

namespace rgbd_pose {

std::string DepthNoiseModel::Check() const {
  if (!std::isfinite(constant) || !std::isfinite(quadratic) ||
      !std::isfinite(centre) || constant < 0.0 || quadratic < 0.0) {
    return "constant and quadratic must not be negative";
  }
  if (!(mean_share > 0.0 && mean_share <= 1.0)) {
    return "mean_share must be above 0 and at most 1";
  }
  // Only depths above 0 count.
  const bool is_somewhere_certain =
      constant == 0.0 && (quadratic == 0.0 || centre > 0.0);
  return is_somewhere_certain ? "sigma(z) = constant + quadratic (z - "
                                "centre)^2 must be above 0 for all depths"
                              : "";
}

const std::vector<DepthNoiseModel>& DepthNoiseModels() {
  static const auto& models = *new std::vector<DepthNoiseModel>{
      {"kinect", 0.0008, 0.0029, 0.0, 0.95},
      {"khoshelham", 0.0, 1.425e-3},
      {"nguyen", 0.0012, 0.0019, 0.4},
      {"constant", 0.005},
  };
  return models;
}

}  // namespace rgbd_pose
