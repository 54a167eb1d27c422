#pragma once

#include "core/geometry/motion.h"
#include "core/util/lane_math.h"
#include "costs/parts/cost_input.h"
#include "costs/parts/moved_point.h"
#include "costs/parts/point_sums.h"
#include "costs/parts/ray_whitening.h"

namespace rgbd_pose {

// The thesis' cost: the 3D error of a match in both frames.
//
//   e_c = X_cur  - R (X_prev - C)      current error   (Tables 2.3, 2.4, 2.5)
//   e_p = X_prev - (R^T X_cur + C)     previous error  (Tables 2.6, 2.7, 2.8)
//
// Rows 0-2 are e_c whitened by the noise of the current frame, rows 3-5 are e_p
// whitened by the noise of the previous frame, each along the measurement's
// axes (u, v, depth; ray_whitening.h). As e_p = -R^T e_c, the six rows contain
// three independent measurements, each twice, and each error has the noise of
// both frames. So a row's sigma is twice the sigma of one frame's measurement:
// (1/4) e^T (S_cur^-1 + S_prev^-1) e equals the Mahalanobis distance
// e^T (S_cur + S_prev)^-1 e if both frames are equally noisy.
struct BidirectionalPoint {
  static constexpr char kName[] = "bidirectional_point";
  static constexpr int kRows = 6;
  static constexpr int kDegreesOfFreedom = 3;
  static constexpr bool kIsWhitened = true;
  static constexpr int kColumns = 2 * RayWhitening<double>::kColumns;

  // Writes the columns of match i; returns false if a depth is missing.
  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Correspondences& matches = input.matches;
    const Observation& prev = matches[i].prev;
    const Observation& cur = matches[i].cur;
    if (prev.depth <= 0.0 || cur.depth <= 0.0) return false;
    constexpr double kSigmaFactor = 2.0;  // see above
    PackRay(matches.camera(), prev, kSigmaFactor, columns);
    PackRay(matches.camera(), cur, kSigmaFactor,
            columns + RayWhitening<double>::kColumns);
    return true;
  }

  // The six residuals, for any mix of scalars; the oracle differentiates this.
  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    const RayWhitening<D> prev(columns);
    const RayWhitening<D> cur(columns + RayWhitening<D>::kColumns);
    T e_c[3], e_p[3];
    Forward::TransformPoint(motion, prev.point, e_c);
    Backward::TransformPoint(motion, cur.point, e_p);
    for (int i = 0; i < 3; ++i) {
      e_c[i] = cur.point[i] - e_c[i];
      e_p[i] = prev.point[i] - e_p[i];
    }
    cur.Whiten(e_c, r);
    prev.Whiten(e_p, r + 3);
  }

  // The residuals and their hand-written derivatives
  // J[row][alpha beta gamma Cx Cy Cz] (docs/jacobian_tables.md).
  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    const RayWhitening<D> prev(columns);
    const RayWhitening<D> cur(columns + RayWhitening<D>::kColumns);
    D from_prev[3], from_cur[3];  // C - X_prev and -X_cur
    for (int i = 0; i < 3; ++i) {
      from_prev[i] = motion.C[i] - prev.point[i];
      from_cur[i] = -cur.point[i];
    }
    for (int angle = 0; angle < 3; ++angle) {
      D de[3];
      // Tables 2.3, 2.4, 2.5: d e_c / d angle = (dR / d angle) (C - X_prev).
      Multiply(motion.dR[angle], from_prev, de);
      cur.WhitenColumn(de, J, angle);
      // Tables 2.6, 2.7, 2.8: d e_p / d angle = -(dR / d angle)^T X_cur.
      MultiplyTransposed(motion.dR[angle], from_cur, de);
      prev.WhitenColumn(de, J + 3, angle);
    }
    // Table 2.9: d e_c / dC = R.
    for (int axis = 0; axis < 3; ++axis) {
      cur.WhitenColumn(motion.R.col(axis).data(), J, 3 + axis);
    }
    // Table 2.9: d e_p / dC = -I.
    prev.WhitenNegativeIdentity(J + 3, 3);
  }

  // The same for the compressed sums (point_sums.h): e_c depends on the motion
  // through q = R (X_prev - C), e_p through q = R^T X_cur + C. Both decrease by
  // as much as q increases: A = -W.
  static constexpr int kPointTerms = 2;

  template <typename D>
  static void PointTerms(const MotionDerivatives& motion, const D* columns,
                         PointTerm<D>* terms) {
    PointTerm<D>* const forward = &terms[0];
    PointTerm<D>* const backward = &terms[1];
    const RayWhitening<D> prev(columns);
    const RayWhitening<D> cur(columns + RayWhitening<D>::kColumns);
    Forward::TransformPoint(motion, prev.point, forward->q);
    // The backward point minus C: rotating it about C rotates R^T X_cur.
    MultiplyTransposed(motion.R, cur.point, backward->q);
    D e_c[3], e_p[3];
    for (int i = 0; i < 3; ++i) {
      e_c[i] = cur.point[i] - forward->q[i];
      e_p[i] = prev.point[i] - motion.C[i] - backward->q[i];
    }
    cur.Square(e_c, forward);
    prev.Square(e_p, backward);
  }
};

}  // namespace rgbd_pose
