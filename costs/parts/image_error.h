#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "core/estimation/correspondences.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/util/lane_math.h"
#include "costs/parts/moved_point.h"
#include "costs/parts/whitening.h"

namespace rgbd_pose {

// Nearer than any depth camera measures, m.
constexpr double kNearestDepth = 0.1;

// The projection of a point q into a camera: m = (a, b, w) with
//
//   a = q_x w = (u - cx) / fx,  b = q_y w = (v - cy) / fy,  w = 1 / q_z.
//
// Nearer than z0 = kNearestDepth and behind the camera, the inverse depth
// continues along its tangent, w = (2 z0 - q_z) / z0^2: it grows the farther a
// point lies behind, and no motion gains by moving points there, where -q would
// give the same image. T is double, ceres::Jet or a vector of doubles.
template <typename T>
class Projection {
 public:
  // q[3] must outlive the projection.
  explicit Projection(const T* q) : q_(q) {
    T z;
    Max(q[2], kNearestDepth, &z);
    const T inverse = 1.0 / z;
    m_[2] = inverse * (2.0 - q[2] * inverse);
    m_[0] = q[0] * m_[2];
    m_[1] = q[1] * m_[2];
    slope_ = -inverse * inverse;
  }

  const T* m() const { return m_; }

  // dm for a small dq.
  void Derivative(const T* dq, T* dm) const {
    dm[2] = slope_ * dq[2];
    dm[0] = m_[2] * dq[0] + q_[0] * dm[2];
    dm[1] = m_[2] * dq[1] + q_[1] * dm[2];
  }

 private:
  const T* q_;
  T m_[3];
  T slope_;  // dw / dq_z
};

// The whitened error of a point of one frame, moved and projected into the
// other frame, against its measurement there: u and v (N = 2) or u, v and
// inverse depth (N = 3), as in Projection. Direction is Forward or Backward
// (moved_point.h). Columns: the point, its measurement and the whitening.
template <int N, typename Direction>
struct ImageError {
  static constexpr int kWhitening = 3 + N;
  static constexpr int kColumns = kWhitening + Whitening<N>::kColumns;

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T q[3];
    Direction::TransformPoint(motion, columns, q);
    WhitenError(columns, Projection<T>(q), r);
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    D q[3];
    Direction::TransformPoint(motion, columns, q);
    const Projection<D> projection(q);
    WhitenError(columns, projection, r);
    for (int parameter = 0; parameter < 6; ++parameter) {
      D dq[3], dm[3], de[N];
      Direction::Derivative(motion, columns, parameter, dq);
      projection.Derivative(dq, dm);
      for (int i = 0; i < N; ++i) de[i] = -dm[i];
      Whitening<N>::WhitenColumn(columns + kWhitening, de, J, parameter);
    }
  }

 private:
  template <typename D, typename T>
  static void WhitenError(const D* columns, const Projection<T>& projection,
                          T* r) {
    T e[N];
    for (int i = 0; i < N; ++i) e[i] = columns[3 + i] - projection.m()[i];
    Whitening<N>::Whiten(columns + kWhitening, e, r);
  }
};

// Writes the columns of an ImageError: a point of `source`, which must have
// depth, against its measurement `target`. The covariance is the sum of the
// covariances of the measurement and of the projected point at
// `target_from_source`, times `repeats`. If the target has no depth, the row of
// inverse depth gets weight 0. Returns false if the noise cannot be whitened.
template <int N>
bool PackImageError(const Correspondences& matches,
                    const Rigid3d& target_from_source,
                    const Observation& source, const Observation& target,
                    double repeats, double* columns) {
  const Camera& camera = matches.camera();
  const Eigen::Vector3d point = matches.Point(source);
  const Eigen::Matrix3d R = target_from_source.rotation.toRotationMatrix();
  const Eigen::Vector3d moved = target_from_source * point;
  const Projection<double> projection(moved.data());
  Eigen::Matrix3d P;  // of the projection by the point
  for (int k = 0; k < 3; ++k) {
    projection.Derivative(R.col(k).data(), P.col(k).data());
  }
  Eigen::Matrix3d covariance =
      P * PointCovariance(camera, source) * P.transpose();
  const bool has_depth = target.depth > 0.0;
  const double w = has_depth ? 1.0 / target.depth : 0.0;
  Eigen::Vector3d measured = camera.Ray(target.u, target.v);
  measured.z() = w;
  const Eigen::Vector3d sigma(target.sigma_px / camera.fx,
                              target.sigma_px / camera.fy,
                              target.sigma_depth * w * w);
  covariance.diagonal() += sigma.cwiseAbs2();
  covariance *= repeats;
  columns = std::copy_n(point.data(), 3, columns);
  columns = std::copy_n(measured.data(), N, columns);
  if (N == 3 && has_depth) return PackWhitening<3>(covariance, columns);
  std::fill_n(columns, Whitening<N>::kColumns, 0.0);
  return PackWhitening<2>(covariance.topLeftCorner<2, 2>(), columns);
}

}  // namespace rgbd_pose
