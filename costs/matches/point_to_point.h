#pragma once

#include <cmath>

#include "core/estimation/motion_cost.h"
#include "costs/parts/forward_error.h"

namespace rgbd_pose {

// The plain 3D error of a match, as in closed-form alignment (Horn 1987; Arun,
// Huang & Blostein 1987): e = X_cur - R (X_prev - C), divided by one sigma for
// all directions. sigma^2 is the mean of the variances of e along the axes,
// trace(S_cur + R S_prev R^T) / 3, and does not depend on the motion.
//
// The errors of a depth camera are many times larger along the ray than across
// it, so the rows are not whitened: their squared norm has longer tails than
// chi^2 of three degrees, and the covariance comes from their scatter.
struct PointToPoint : WeightedForwardError<PointToPoint, 3> {
  static constexpr char kName[] = "point_to_point";
  static constexpr bool kIsWhitened = false;
  static constexpr int kColumns = ForwardError::kColumns + 2;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    if (!ForwardError::Pack(input, i, columns)) return false;
    const Eigen::Matrix3d S = ForwardError::Covariance(input, i);
    columns[6] = 1.0 / std::sqrt(S.trace() / 3);
    columns[7] = S.trace() * S.trace() / S.squaredNorm();
    return true;
  }

  // The squared norm is a sum of squares with unequal variances. It has mean 3
  // and the variance of 3 / h times chi^2 of h degrees, 1 <= h <= 3
  // (Satterthwaite 1946); the quantile is from Wilson & Hilferty 1931.
  static double InlierLimit(const double* columns) {
    constexpr double kNormal99 = 2.3263;
    const double v = 2.0 / (9.0 * columns[7]);
    const double root = 1.0 - v + kNormal99 * std::sqrt(v);
    return 3.0 * root * root * root;
  }

  template <typename D, typename T>
  [[gnu::always_inline]] static void Weigh(const D* weight, const T* e, T* r) {
    for (int row = 0; row < 3; ++row) r[row] = weight[0] * e[row];
  }
};

}  // namespace rgbd_pose
