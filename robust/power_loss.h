#pragma once

#include <ceres/loss_function.h>

#include <cmath>

namespace rgbd_pose {

// |x|^v for 1 <= v < 2 (Zhang's L1 and Lp), w(x) = (|x|/c)^(v-2):
//
//   R(s) = (2/v) c^2 (s / c^2)^(v/2).
//
// The width c only scales it; c = 1 is Zhang's. As its slope at 0 is infinite,
// s is replaced by s + (kEpsilon c)^2, less the value at 0: nearer than
// kEpsilon widths it turns into least squares of weight kEpsilon^(v-2). So its
// weights exceed 1 for residuals below the width.
class PowerLoss final : public ceres::LossFunction {
 public:
  static constexpr double kEpsilon = 0.01;

  PowerLoss(double exponent, double width)
      : exponent_(exponent),
        width2_(width * width),
        at_zero_(std::pow(kEpsilon, exponent)) {}

  void Evaluate(double s, double rho[3]) const override {
    const double q = s / width2_ + kEpsilon * kEpsilon;
    const double power = std::pow(q, 0.5 * exponent_);
    rho[0] = 2.0 / exponent_ * width2_ * (power - at_zero_);
    rho[1] = power / q;
    rho[2] = (0.5 * exponent_ - 1.0) * rho[1] / (q * width2_);
  }

 private:
  double exponent_;
  double width2_;
  double at_zero_;
};

}  // namespace rgbd_pose
