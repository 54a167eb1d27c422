#pragma once

#include <ceres/jet.h>

#include <cstring>

#include "core/geometry/motion.h"

namespace rgbd_pose {

// Detects a hand-written Jacobian of a residual type (cost_of.h).
template <typename Type>
using JacobianOf = decltype(&Type::template Jacobian<double>);

// Adds an automatic Jacobian to a residual type without one. It works match by
// match: several times slower than a hand-written one, but correct from the
// start.
template <typename Type>
struct WithAutodiffJacobian : Type {
  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    constexpr int kRows = Type::kRows;
    constexpr int kColumns = Type::kColumns;
    // NOLINTNEXTLINE(bugprone-sizeof-expression): D may be one double.
    constexpr int kLanes = sizeof(D) / sizeof(double);
    double match[kColumns][kLanes];
    double rows[kRows][kLanes];
    double derivatives[kRows][6][kLanes];
    std::memcpy(match, columns, sizeof(match));
    for (int lane = 0; lane < kLanes; ++lane) {
      double m[kColumns], values[kRows], gradients[kRows][6];
      for (int k = 0; k < kColumns; ++k) m[k] = match[k][lane];
      Differentiate(motion, m, values, gradients);
      for (int row = 0; row < kRows; ++row) {
        rows[row][lane] = values[row];
        for (int k = 0; k < 6; ++k) {
          derivatives[row][k][lane] = gradients[row][k];
        }
      }
    }
    std::memcpy(r, rows, sizeof(rows));
    std::memcpy(J, derivatives, sizeof(derivatives));
  }

 private:
  using Jet = ceres::Jet<double, 6>;

  // Compiled once and not for every instruction set, which would take long.
  [[gnu::noinline]] static void Differentiate(const MotionDerivatives& motion,
                                              const double* columns, double* r,
                                              double (*J)[6]) {
    Jet residuals[Type::kRows];
    Type::Residual(JetsOf(motion), columns, residuals);
    for (int row = 0; row < Type::kRows; ++row) {
      r[row] = residuals[row].a;
      for (int k = 0; k < 6; ++k) J[row][k] = residuals[row].v[k];
    }
  }

  // R and C with their derivatives by the six parameters.
  static RotationAndCenter<Jet> JetsOf(const MotionDerivatives& motion) {
    RotationAndCenter<Jet> pose;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        Jet& entry = pose.R(row, column);
        entry = Jet(motion.R(row, column));
        for (int k = 0; k < 3; ++k) entry.v[k] = motion.dR[k](row, column);
      }
      pose.C[row] = Jet(motion.C[row], 3 + row);
    }
    return pose;
  }
};

}  // namespace rgbd_pose
