#pragma once

#include "core/estimation/batch_loss.h"
#include "core/util/lane_math.h"

namespace rgbd_pose {

// Tukey's biweight, w(x) = (1 - (x/c)^2)^2 if x <= c, 0 beyond:
//
//   R(s) = c^2/3 (1 - (1 - s/c^2)^3) if s <= c^2, c^2/3 beyond,
//
// as ceres::TukeyLoss of 2.0 and later (before, it was half of that).
class TukeyFormula {
 public:
  explicit TukeyFormula(double width) : c2_(width * width) {}

  template <typename T>
  void Weigh(const T& s, T* rho, T* weight) const {
    T rest;  // 1 - s/c^2, not below 0
    Max(T(1.0 - s / c2_), 0.0, &rest);
    *weight = rest * rest;
    *rho = c2_ / 3.0 * (1.0 - *weight * rest);
  }

  double Curvature(double s) const {
    return s > c2_ ? 0.0 : -2.0 / c2_ * (1.0 - s / c2_);
  }

 private:
  double c2_;
};

using TukeyLoss = BatchLossOf<TukeyFormula>;

}  // namespace rgbd_pose
