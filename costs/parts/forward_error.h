#pragma once

#include <Eigen/Core>

#include "core/estimation/motion_cost.h"
#include "core/geometry/motion.h"
#include "costs/parts/moved_point.h"
#include "costs/parts/whitening.h"

namespace rgbd_pose {

// The 3D error of a match in current axes, e = X_cur - R (X_prev - C), in
// metres, before whitening.
struct ForwardError {
  static constexpr int kColumns = 6;  // X_prev, X_cur

  // Writes the columns of match i; returns false if a depth is missing.
  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Correspondences& matches = input.matches;
    const Observation& prev = matches[i].prev;
    const Observation& cur = matches[i].cur;
    if (prev.depth <= 0.0 || cur.depth <= 0.0) return false;
    Eigen::Map<Eigen::Vector3d> x_prev(columns), x_cur(columns + 3);
    x_prev = matches.Point(prev);
    x_cur = matches.Point(cur);
    return true;
  }

  // Covariance of e (m^2) at the bound motion: S_cur + R S_prev R^T.
  static Eigen::Matrix3d Covariance(const CostInput& input, size_t i) {
    const Camera& camera = input.matches.camera();
    const Eigen::Matrix3d R = input.cur_from_prev.rotation.toRotationMatrix();
    return PointCovariance(camera, input.matches[i].cur) +
           R * PointCovariance(camera, input.matches[i].prev) * R.transpose();
  }

  // e (m), from the columns of a match.
  template <typename M, typename D, typename T>
  static void Error(const RotationAndCenter<M>& motion, const D* columns,
                    T* e) {
    T q[3];
    Forward::TransformPoint(motion, columns, q);
    for (int i = 0; i < 3; ++i) e[i] = columns[3 + i] - q[i];
  }
};

// Common part of the costs whose residual is linear in the error: r = W e, with
// weights W that are frozen at the bound motion. Type::Weigh(weights, e, r)
// multiplies, for any scalars; the weights follow the columns of ForwardError.
template <typename Type, int rows>
struct WeightedForwardError {
  // Constants that every residual type has, see CostOf.
  static constexpr int kRows = rows;
  static constexpr int kDegreesOfFreedom = rows;
  static constexpr bool kIsWhitened = true;
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kWhenMoved;

  // The residual r = W e.
  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T e[3];
    ForwardError::Error(motion, columns, e);
    Type::Weigh(columns + ForwardError::kColumns, e, r);
  }

  // r and dr / dx = W de / dx.
  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    for (int parameter = 0; parameter < 6; ++parameter) {
      D de[3], dr[rows];
      Forward::Derivative(motion, columns, parameter, de);
      for (int i = 0; i < 3; ++i) de[i] = -de[i];
      Type::Weigh(columns + ForwardError::kColumns, de, dr);
      for (int row = 0; row < rows; ++row) J[row][parameter] = dr[row];
    }
  }
};

}  // namespace rgbd_pose
