#pragma once

#include <ceres/loss_function.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbd_pose {

// Fair's loss, w(x) = 1 / (1 + |x|/c):
//
//   R(s) = 2 c^2 (|x|/c - ln(1 + |x|/c)),  |x| = sqrt s.
//
// R''(0) is minus infinity; what is given there is huge, but finite, so that
// s R''(s) is 0.
class FairLoss final : public ceres::LossFunction {
 public:
  explicit FairLoss(double width) : width_(width) {}

  void Evaluate(double s, double rho[3]) const override {
    constexpr double kTiny = std::numeric_limits<double>::min();
    const double q = std::sqrt(s) / width_;
    const double weight = 1.0 / (1.0 + q);
    rho[0] = 2.0 * width_ * width_ * (q - std::log1p(q));
    rho[1] = weight;
    rho[2] = -0.5 * weight * weight / (width_ * std::sqrt(std::max(s, kTiny)));
  }

 private:
  double width_;
};

}  // namespace rgbd_pose
