#pragma once

#include <cmath>

#include "core/estimation/motion_cost.h"
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
struct PointToPlane : WeightedForwardError<PointToPlane, 1> {
  static constexpr char kName[] = "point_to_plane";
  static constexpr int kColumns = ForwardError::kColumns + 3;  // n / sigma

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Eigen::Vector3d n = input.matches[i].cur.normal;
    if (n.isZero(0.0) || !ForwardError::Pack(input, i, columns)) return false;
    const double variance = n.dot(ForwardError::Covariance(input, i) * n);
    Eigen::Map<Eigen::Vector3d>(columns + ForwardError::kColumns) =
        n / std::sqrt(variance);
    return true;
  }

  template <typename D, typename T>
  [[gnu::always_inline]] static void Weigh(const D* n, const T* e, T* r) {
    r[0] = n[0] * e[0] + n[1] * e[1] + n[2] * e[2];
  }
};

}  // namespace rgbd_pose
