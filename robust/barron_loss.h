#pragma once

#include <ceres/loss_function.h>

#include <cmath>

namespace rgbd_pose {

// Barron's family (A General and Adaptive Robust Loss Function, CVPR 2019),
// scaled to R'(0) = 1; w(x) = (1 + (x/c)^2 / (2-a))^(a/2-1):
//
//   R(s) = 2 c^2 (2-a)/a ((1 + s / (c^2 (2-a)))^(a/2) - 1).
//
// The shape a <= 2 leads from least squares (2) by L1-L2 (1), Cauchy (0) and
// Geman-McClure (-2) towards Welsch (minus infinity): the lower, the less far
// residuals count. Below 1 it is redescending. (The R'' of shapes above 2 is
// positive, which the compressed block does not support.)
class BarronLoss final : public ceres::LossFunction {
 public:
  // Half-way between Cauchy and Geman-McClure.
  static constexpr double kDefaultAlpha = -1.0;

  explicit BarronLoss(double width, double alpha = kDefaultAlpha)
      : alpha_(alpha), width2_(width * width) {}

  void Evaluate(double s, double rho[3]) const override {
    const double gap = 2.0 - alpha_;
    if (gap <= 0.0) {
      rho[0] = s;
      rho[1] = 1.0;
      rho[2] = 0.0;
      return;
    }
    const double q = s / (width2_ * gap);
    const double log = std::log1p(q);
    const double growth =
        alpha_ == 0.0 ? 0.5 * log : std::expm1(0.5 * alpha_ * log) / alpha_;
    rho[0] = 2.0 * width2_ * gap * growth;
    rho[1] = std::exp(-0.5 * gap * log);
    rho[2] = -0.5 * rho[1] / (width2_ * (1.0 + q));
  }

 private:
  double alpha_;
  double width2_;
};

}  // namespace rgbd_pose
