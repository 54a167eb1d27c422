#pragma once

#include "core/cost.h"
#include "core/motion.h"
#include "costs/point_sums.h"
#include "costs/ray_whitening.h"

namespace rgbd_pose {

// The thesis' cost: the 3D error of a match in both frames.
//
//   e_c = X_cur  - R (X_prev - C)      current error   (Tables 2.3, 2.4, 2.5)
//   e_p = X_prev - (R^T X_cur + C)     previous error  (Tables 2.6, 2.7, 2.8)
//
// Rows 0-2 are e_c whitened by the noise of the current frame, rows 3-5 are e_p
// whitened by that of the previous frame, each along the measurement's own axes
// (u, v, depth; ray_whitening.h). e_p = -R^T e_c: the six rows hold three
// independent measurements, each told twice, and each error carries the noise
// of both frames. So one sigma of a row is twice that of one frame's
// measurement: (1/4) e^T (S_cur^-1 + S_prev^-1) e equals the Mahalanobis
// distance e^T (S_cur + S_prev)^-1 e where both frames are equally noisy.
struct BidirectionalPoint {
  static constexpr char kName[] = "bidirectional_point";
  static constexpr int kRows = 6;
  static constexpr int kIndependentRows = 3;
  static constexpr bool kFreezesWeights = false;
  static constexpr bool kIsWhitened = true;
  static constexpr int kColumns = 2 * RayWhitening<double>::kColumns;

  // Writes what the residual needs of match i; false if a depth is missing.
  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Correspondences& matches = input.matches;
    const Observation prev = matches.prev()[i];
    const Observation cur = matches.cur()[i];
    if (prev.depth <= 0.0 || cur.depth <= 0.0) return false;
    constexpr double kSigmaFactor = 2.0;  // see above
    PackRay(matches.camera(), prev, kSigmaFactor, columns);
    PackRay(matches.camera(), cur, kSigmaFactor,
            columns + RayWhitening<double>::kColumns);
    return true;
  }

  // The six residuals, for any mix of scalars: this is what the oracle
  // differentiates.
  template <typename M, typename D, typename T>
  static void Residual(const MotionPose<M>& motion, const D* columns, T* r) {
    const RayWhitening<D> prev(columns);
    const RayWhitening<D> cur(columns + RayWhitening<D>::kColumns);
    const auto& R = motion.R;
    const T d[3] = {prev.x - motion.C[0], prev.y - motion.C[1],
                    prev.z - motion.C[2]};
    const T e_c[3] = {
        cur.x - (R(0, 0) * d[0] + R(0, 1) * d[1] + R(0, 2) * d[2]),
        cur.y - (R(1, 0) * d[0] + R(1, 1) * d[1] + R(1, 2) * d[2]),
        cur.z - (R(2, 0) * d[0] + R(2, 1) * d[1] + R(2, 2) * d[2])};
    const T e_p[3] = {
        d[0] - (R(0, 0) * cur.x + R(1, 0) * cur.y + R(2, 0) * cur.z),
        d[1] - (R(0, 1) * cur.x + R(1, 1) * cur.y + R(2, 1) * cur.z),
        d[2] - (R(0, 2) * cur.x + R(1, 2) * cur.y + R(2, 2) * cur.z)};
    cur.Whiten(e_c, r);
    prev.Whiten(e_p, r + 3);
  }

  // The residuals and their derivatives J[row][alpha beta gamma Cx Cy Cz],
  // by hand (docs/jacobian_tables.md).
  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    const RayWhitening<D> prev(columns);
    const RayWhitening<D> cur(columns + RayWhitening<D>::kColumns);
    const D d[3] = {prev.x - motion.C[0], prev.y - motion.C[1],
                    prev.z - motion.C[2]};
    for (int angle = 0; angle < 3; ++angle) {
      const Eigen::Matrix3d& dR = motion.dR[angle];
      // Tables 2.3, 2.4, 2.5: d e_c / d angle = -(dR / d angle) (X_prev - C).
      const D forward[3] = {
          -(dR(0, 0) * d[0] + dR(0, 1) * d[1] + dR(0, 2) * d[2]),
          -(dR(1, 0) * d[0] + dR(1, 1) * d[1] + dR(1, 2) * d[2]),
          -(dR(2, 0) * d[0] + dR(2, 1) * d[1] + dR(2, 2) * d[2])};
      cur.WhitenColumn(forward, J, angle);
      // Tables 2.6, 2.7, 2.8: d e_p / d angle = -(dR / d angle)^T X_cur.
      const D backward[3] = {
          -(dR(0, 0) * cur.x + dR(1, 0) * cur.y + dR(2, 0) * cur.z),
          -(dR(0, 1) * cur.x + dR(1, 1) * cur.y + dR(2, 1) * cur.z),
          -(dR(0, 2) * cur.x + dR(1, 2) * cur.y + dR(2, 2) * cur.z)};
      prev.WhitenColumn(backward, J + 3, angle);
    }
    for (int axis = 0; axis < 3; ++axis) {
      // Table 2.9: d e_c / dC = R, d e_p / dC = -I.
      const double forward[3] = {motion.R(0, axis), motion.R(1, axis),
                                 motion.R(2, axis)};
      cur.WhitenColumn(forward, J, 3 + axis);
      const double backward[3] = {axis == 0 ? -1.0 : 0.0,
                                  axis == 1 ? -1.0 : 0.0,
                                  axis == 2 ? -1.0 : 0.0};
      prev.WhitenColumn(backward, J + 3, 3 + axis);
    }
  }

  // The same for the compressed sums (point_sums.h): e_c depends on the motion
  // through q = R (X_prev - C), e_p through q = R^T X_cur + C, and both fall by
  // as much as q rises: A = -W.
  static constexpr bool kHasPointTerms = true;

  template <typename D>
  static void PointTerms(const MotionDerivatives& motion, const D* columns,
                         PointTerm<D>* forward, PointTerm<D>* backward) {
    const RayWhitening<D> prev(columns);
    const RayWhitening<D> cur(columns + RayWhitening<D>::kColumns);
    const Eigen::Matrix3d& R = motion.R;
    const D d[3] = {prev.x - motion.C[0], prev.y - motion.C[1],
                    prev.z - motion.C[2]};
    // The backward point less C: turning it about C is turning R^T X_cur.
    for (int i = 0; i < 3; ++i) {
      forward->q[i] = R(i, 0) * d[0] + R(i, 1) * d[1] + R(i, 2) * d[2];
      backward->q[i] = R(0, i) * cur.x + R(1, i) * cur.y + R(2, i) * cur.z;
    }
    const D e_c[3] = {cur.x - forward->q[0], cur.y - forward->q[1],
                      cur.z - forward->q[2]};
    const D e_p[3] = {d[0] - backward->q[0], d[1] - backward->q[1],
                      d[2] - backward->q[2]};
    cur.Square(e_c, forward);
    prev.Square(e_p, backward);
  }
};

}  // namespace rgbd_pose
