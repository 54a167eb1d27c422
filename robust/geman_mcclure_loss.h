#pragma once

#include <ceres/loss_function.h>

namespace rgbd_pose {

// Geman and McClure's loss, w(x) = (1 + (x/c)^2)^-2:
//
//   R(s) = s / (1 + s/c^2).
//
// It is bounded by c^2. Zhang's has c = 1.
class GemanMcClureLoss final : public ceres::LossFunction {
 public:
  explicit GemanMcClureLoss(double width) : inverse_(1.0 / (width * width)) {}

  void Evaluate(double s, double rho[3]) const override {
    const double t = 1.0 / (1.0 + s * inverse_);
    rho[0] = s * t;
    rho[1] = t * t;
    rho[2] = -2.0 * inverse_ * t * t * t;
  }

 private:
  double inverse_;
};

}  // namespace rgbd_pose
