#pragma once

#include "core/estimation/motion_cost.h"
#include "core/geometry/motion.h"
#include "core/util/lane_math.h"
#include "costs/parts/moved_point.h"
#include "costs/parts/point_sums.h"

namespace rgbd_pose {

// The point of an observation, and the whitening r = L^T e of a 3D error e at
// that point along the axes of the measurement (docs/jacobian_tables.md). On
// the ray (a, b, 1) an error of depth also moves x = a z and y = b z, so
//
//   r = [ w_u (e_x - a e_z), w_v (e_y - b e_z), w_z e_z ],
//   w_u = fx / (z sigma_px), w_v = fy / (z sigma_px), w_z = 1 / sigma_depth.
//
// L L^T is the inverse of PointCovariance. D is double or a vector of doubles.
template <typename D>
struct RayWhitening {
  static constexpr int kColumns = 6;

  // Takes six columns: a, b, z, w_u, w_v, w_z.
  explicit RayWhitening(const D* columns)
      : a(columns[0]),
        b(columns[1]),
        point{columns[0] * columns[2], columns[1] * columns[2], columns[2]},
        w_u(columns[3]),
        w_v(columns[4]),
        w_z(columns[5]) {}

  // r = L^T e.
  template <typename T>
  void Whiten(const T* e, T* r) const {
    r[0] = w_u * (e[0] - a * e[2]);
    r[1] = w_v * (e[1] - b * e[2]);
    r[2] = w_z * e[2];
  }

  // The same for one column of a Jacobian, into rows J[0..2].
  template <typename T>
  void WhitenColumn(const T* e, D (*J)[6], int column) const {
    J[0][column] = w_u * (e[0] - a * e[2]);
    J[1][column] = w_v * (e[1] - b * e[2]);
    J[2][column] = w_z * e[2];
  }

  // The same for the three columns of -I, starting at `column`. Written out,
  // because a compiler must not leave out products with 0.
  void WhitenNegativeIdentity(D (*J)[6], int column) const {
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) J[row][column + k] = D{};
    }
    J[0][column] -= w_u;
    J[0][column + 2] += w_u * a;
    J[1][column + 1] -= w_v;
    J[1][column + 2] += w_v * b;
    J[2][column + 2] -= w_z;
  }

  // N = L L^T and n = -N e of a residual L^T (X - q) of the moved point q.
  void Square(const D* e, PointTerm<D>* term) const {
    const D uu = w_u * w_u;
    const D vv = w_v * w_v;
    const D au = a * uu;
    const D bv = b * vv;
    D* N = term->JtJ;
    N[0] = uu;
    N[1] = uu - uu;
    N[2] = -au;
    N[3] = vv;
    N[4] = -bv;
    N[5] = w_z * w_z + a * au + b * bv;
    term->Jtr[0] = au * e[2] - uu * e[0];
    term->Jtr[1] = bv * e[2] - vv * e[1];
    term->Jtr[2] = au * e[0] + bv * e[1] - N[5] * e[2];
  }

  D a, b;           // the ray: x / z, y / z
  D point[3];       // m
  D w_u, w_v, w_z;  // 1 / m
};

// The columns of an observation with depth; its sigmas are scaled.
inline void PackRay(const Camera& camera, const Observation& o,
                    double sigma_factor, double* columns) {
  // One division instead of three: this runs for every match of every estimate.
  const double sigma = o.depth * o.sigma_px;
  const double inverse = 1.0 / (sigma_factor * sigma * o.sigma_depth);
  const double image = inverse * o.sigma_depth;
  const Eigen::Vector3d ray = camera.Ray(o.u, o.v);
  columns[0] = ray.x();
  columns[1] = ray.y();
  columns[2] = o.depth;
  columns[3] = camera.fx * image;
  columns[4] = camera.fy * image;
  columns[5] = inverse * sigma;
}

// The thesis' cost: the 3D error of a match in both frames
// (docs/jacobian_tables.md).
//
//   rows 0-2  e_c = X_cur  - R (X_prev - C)     whitened by the current noise
//   rows 3-5  e_p = X_prev - (R^T X_cur + C)    whitened by the previous noise
//
// As e_p = -R^T e_c, these are three independent measurements, each twice, and
// each error has the noise of both frames. So a row's sigma is twice that of
// one frame's measurement: (1/4) e^T (S_cur^-1 + S_prev^-1) e equals the
// Mahalanobis distance e^T (S_cur + S_prev)^-1 e if both frames are equally
// noisy.
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

  // The six residuals, for any mix of scalars.
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

  // J[row][alpha beta gamma Cx Cy Cz].
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
