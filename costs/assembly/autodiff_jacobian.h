#pragma once

#include <ceres/jet.h>

#include "core/geometry/motion.h"

namespace rgbd_pose {

// Detects a hand-written Jacobian of a residual type (see CostOf).
template <typename Type>
using JacobianOf = decltype(&Type::template Jacobian<double>);

// Adds an automatic Jacobian to a residual type without one. It works match by
// match: several times slower than a hand-written one, but correct.
template <typename Type>
struct WithAutodiffJacobian : Type {
  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    // NOLINTNEXTLINE(bugprone-sizeof-expression): D may be one double.
    constexpr int kLanes = sizeof(D) / sizeof(double);
    const auto* const lanes = reinterpret_cast<const double*>(columns);
    for (int lane = 0; lane < kLanes; ++lane) {
      double match[Type::kColumns];
      for (int k = 0; k < Type::kColumns; ++k) {
        match[k] = lanes[k * kLanes + lane];
      }
      Differentiate(motion, match, kLanes, reinterpret_cast<double*>(r) + lane,
                    reinterpret_cast<double*>(J) + lane);
    }
  }

 private:
  // Writes every stride-th number of r and J. Compiled once and not for every
  // instruction set, which would take long.
  [[gnu::noinline]] static void Differentiate(const MotionDerivatives& motion,
                                              const double* columns, int stride,
                                              double* r, double* J) {
    using Jet = ceres::Jet<double, 6>;
    // R and C with their derivatives by the six parameters.
    RotationAndCenter<Jet> pose;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        Jet& entry = pose.R(row, column);
        entry = Jet(motion.R(row, column));
        for (int k = 0; k < 3; ++k) entry.v[k] = motion.dR[k](row, column);
      }
      pose.C[row] = Jet(motion.C[row], 3 + row);
    }
    Jet residuals[Type::kRows];
    Type::Residual(pose, columns, residuals);
    for (int row = 0; row < Type::kRows; ++row) {
      r[row * stride] = residuals[row].a;
      for (int k = 0; k < 6; ++k) {
        J[(6 * row + k) * stride] = residuals[row].v[k];
      }
    }
  }
};

}  // namespace rgbd_pose
