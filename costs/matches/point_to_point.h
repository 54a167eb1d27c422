#pragma once

#include <cmath>

#include "core/estimation/motion_cost.h"
#include "costs/parts/cost_input.h"
#include "costs/parts/forward_error.h"

namespace rgbd_pose {

// The plain 3D error of a match, as in closed-form alignment (Horn 1987; Arun,
// Huang & Blostein 1987): e = X_cur - R (X_prev - C), divided by one sigma for
// all directions. sigma^2 is the mean of the variances of e along the axes,
// trace(S_cur + R S_prev R^T) / 3, and does not depend on the motion.
//
// The errors of a depth camera are many times larger along the ray than across
// it. One sigma for all directions wastes information of the image, and the
// rows do not have unit variance. They are not whitened, so the covariance
// comes from their scatter. Their squared norm has longer tails than chi^2 of
// three degrees; how long depends on the bound motion.
struct PointToPoint {
  static constexpr char kName[] = "point_to_point";
  static constexpr int kRows = 3;
  static constexpr int kDegreesOfFreedom = 3;
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kWhenMoved;
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

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    ForwardError::Error(motion, columns, r);
    for (int row = 0; row < 3; ++row) r[row] *= columns[6];
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    for (int parameter = 0; parameter < 6; ++parameter) {
      D de[3];
      ForwardError::Derivative(motion, columns, parameter, de);
      for (int row = 0; row < 3; ++row)
        J[row][parameter] = columns[6] * de[row];
    }
  }
};

}  // namespace rgbd_pose
