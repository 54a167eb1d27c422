#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

namespace rgbd_pose {

// The derivatives of residuals by a motion, a row each.
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

// The same Jacobian in three ways.
struct JacobianInThreeWays {
  Jacobian by_hand;
  Jacobian by_autodiff;
  Jacobian by_differences;  // central
};

// Those of a direct cost, by name, over two rendered frames: a row for each
// pixel, of which there are at most `max_pixels`, at a random motion near that
// of the frames. Pixels are looked up at the motion of the frames, and stay.
JacobianInThreeWays JacobiansOfPixels(const std::string& cost_name,
                                      int max_pixels, uint32_t seed,
                                      double step);

}  // namespace rgbd_pose
