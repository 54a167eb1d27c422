#pragma once

#include <ceres/loss_function.h>

#include <cmath>

namespace rgbd_pose {

// Welsch's loss, w(x) = exp(-(x/c)^2):
//
//   R(s) = c^2 (1 - exp(-s/c^2)).
class WelschLoss final : public ceres::LossFunction {
 public:
  explicit WelschLoss(double width) : width2_(width * width) {}

  void Evaluate(double s, double rho[3]) const override {
    const double q = s / width2_;
    rho[0] = -width2_ * std::expm1(-q);
    rho[1] = std::exp(-q);
    rho[2] = -rho[1] / width2_;
  }

 private:
  double width2_;
};

}  // namespace rgbd_pose
