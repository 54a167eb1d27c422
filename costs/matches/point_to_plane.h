#pragma once

#include <cmath>

#include "core/estimation/motion_cost.h"
#include "costs/parts/cost_input.h"
#include "costs/parts/forward_error.h"

namespace rgbd_pose {

// The distance of the previous point from the tangent plane at the current one
// (Chen & Medioni 1992; KinectFusion, Newcombe et al. 2011):
//
//   r = n . (X_cur - R (X_prev - C)) / sigma,
//   sigma^2 = n^T (S_cur + R S_prev R^T) n
//
// with the normal n of the current observation, whose length and sign do not
// matter. sigma is frozen at the bound motion. Matches without a normal or a
// depth are not used. A single plane leaves three directions of motion
// undetermined: the matches must lie on surfaces with different orientations.
struct PointToPlane {
  static constexpr char kName[] = "point_to_plane";
  static constexpr int kRows = 1;
  static constexpr int kDegreesOfFreedom = 1;
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kWhenMoved;
  static constexpr bool kIsWhitened = true;
  static constexpr int kColumns = ForwardError::kColumns + 3;  // n / sigma

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Eigen::Vector3d n = input.matches[i].cur.normal;
    if (n.isZero(0.0) || !ForwardError::Pack(input, i, columns)) return false;
    const double variance = n.dot(ForwardError::Covariance(input, i) * n);
    Eigen::Map<Eigen::Vector3d>(columns + ForwardError::kColumns) =
        n / std::sqrt(variance);
    return true;
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T e[3];
    ForwardError::Error(motion, columns, e);
    const D* n = columns + ForwardError::kColumns;
    r[0] = n[0] * e[0] + n[1] * e[1] + n[2] * e[2];
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    const D* n = columns + ForwardError::kColumns;
    for (int parameter = 0; parameter < 6; ++parameter) {
      D de[3];
      ForwardError::Derivative(motion, columns, parameter, de);
      J[0][parameter] = n[0] * de[0] + n[1] * de[1] + n[2] * de[2];
    }
  }
};

}  // namespace rgbd_pose
