#pragma once

#include "core/estimation/batch_loss.h"
#include "core/util/lane_math.h"

namespace rgbd_pose {

// Huber's loss, w(x) = 1 if x <= c, c / x beyond:
//
//   R(s) = s if s <= c^2, 2 c sqrt(s) - c^2 beyond,
//
// as ceres::HuberLoss.
class HuberFormula {
 public:
  explicit HuberFormula(double width) : c_(width), c2_(width * width) {}

  template <typename T>
  void Weigh(const T& s, T* rho, T* weight) const {
    // sqrt of at least c^2: where it does not count it must not divide by 0.
    T limited;
    Max(s, c2_, &limited);
    const T root = sqrt(limited);
    const T one = T{} + 1.0;
    *rho = s > c2_ ? 2.0 * c_ * root - c2_ : s;
    *weight = s > c2_ ? c_ / root : one;
  }

  double Curvature(double s) const {
    return s > c2_ ? -0.5 * c_ / (s * std::sqrt(s)) : 0.0;
  }

 private:
  double c_, c2_;
};

using HuberLoss = BatchLossOf<HuberFormula>;

}  // namespace rgbd_pose
