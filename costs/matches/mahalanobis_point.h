#pragma once

#include "core/estimation/motion_cost.h"
#include "costs/parts/forward_error.h"
#include "costs/parts/moved_point.h"
#include "costs/parts/point_sums.h"
#include "costs/parts/whitening.h"

namespace rgbd_pose {

// The 3D error of a match under the noise of both of its points (Dryanovski,
// Valenti & Xiao 2013; generalised ICP, Segal, Haehnel & Thrun 2009):
//
//   r = L^T e,  e = X_cur - R (X_prev - C),  L L^T = (S_cur + R S_prev R^T)^-1
//
// with the covariances S of PointCovariance. L is frozen at the bound motion: L
// changes little with the motion, and a weight that follows the motion would
// reward motions that make the noise look large.
struct MahalanobisPoint : WeightedForwardError<MahalanobisPoint, 3> {
  static constexpr char kName[] = "mahalanobis_point";
  static constexpr int kColumns =
      ForwardError::kColumns + Whitening<3>::kColumns;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    return ForwardError::Pack(input, i, columns) &&
           PackWhitening<3>(ForwardError::Covariance(input, i),
                            columns + ForwardError::kColumns);
  }

  template <typename D, typename T>
  [[gnu::always_inline]] static void Weigh(const D* weights, const T* e, T* r) {
    Whitening<3>::Whiten(weights, e, r);
  }

  // The same for the compressed sums (point_sums.h): r = W e decreases by W dq,
  // so A = -W with the lower triangle W = L^T.
  static constexpr int kPointTerms = 1;

  template <typename D>
  static void PointTerms(const MotionDerivatives& motion, const D* columns,
                         PointTerm<D>* term) {
    const D* w = columns + ForwardError::kColumns;
    Forward::TransformPoint(motion, columns, term->q);
    D e[3], r[3];
    for (int i = 0; i < 3; ++i) e[i] = columns[3 + i] - term->q[i];
    Weigh(w, e, r);
    term->JtJ[0] = w[0] * w[0] + w[1] * w[1] + w[3] * w[3];
    term->JtJ[1] = w[1] * w[2] + w[3] * w[4];
    term->JtJ[2] = w[3] * w[5];
    term->JtJ[3] = w[2] * w[2] + w[4] * w[4];
    term->JtJ[4] = w[4] * w[5];
    term->JtJ[5] = w[5] * w[5];
    term->Jtr[0] = -(w[0] * r[0] + w[1] * r[1] + w[3] * r[2]);
    term->Jtr[1] = -(w[2] * r[1] + w[4] * r[2]);
    term->Jtr[2] = -(w[5] * r[2]);
  }
};

}  // namespace rgbd_pose
