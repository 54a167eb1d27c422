#pragma once

#include <Eigen/Core>
#include <array>

#include "core/geometry/rigid3.h"
#include "core/util/lane_math.h"

// The motion between two frames in the six parameters of Lu (Tamkang 2016; see
// docs/jacobian_tables.md):
//
//   x = [alpha beta gamma Cx Cy Cz]   (rad, m)
//   X_cur = R (X_prev - C),  R = Rz(gamma) Ry(beta) Rx(alpha)
//
// C is the centre of the current camera in the axes of the previous one.

namespace rgbd_pose {

// The six parameters, and 6 x 6 matrices over them.
using MotionVector = Eigen::Matrix<double, 6, 1>;
using MotionMatrix = Eigen::Matrix<double, 6, 6>;

// R and C of a motion, for any scalar (double or ceres::Jet).
template <typename T>
struct RotationAndCenter {
  Eigen::Matrix<T, 3, 3> R;  // previous axes to current axes
  Eigen::Matrix<T, 3, 1> C;  // current centre in the previous frame, m
};

// R, C and their derivatives (Table 2.1) except dR/dC = 0 and dC/dC = I.
struct MotionDerivatives : RotationAndCenter<double> {
  std::array<Eigen::Matrix3d, 3> dR;  // by alpha, beta, gamma
};

// The rotation of the three angles: Rz(gamma) Ry(beta) Rx(alpha).
template <typename T>
Eigen::Matrix<T, 3, 3> RotationFromAngles(const T* angles) {
  using std::cos;
  using std::sin;
  const T sa = sin(angles[0]), ca = cos(angles[0]);
  const T sb = sin(angles[1]), cb = cos(angles[1]);
  const T sg = sin(angles[2]), cg = cos(angles[2]);
  Eigen::Matrix<T, 3, 3> R;
  R << cb * cg, sa * sb * cg - ca * sg, ca * sb * cg + sa * sg,  //
      cb * sg, sa * sb * sg + ca * cg, ca * sb * sg - sa * cg,   //
      -sb, sa * cb, ca * cb;
  return R;
}

// The solver's parameters are relative to an origin, the initial guess, and
// thus stay small: no gimbal lock occurs and no manifold is needed.
//
//   R(x) = Rz Ry Rx(angles) R_origin,   C(x) = C_origin + [Cx Cy Cz]
//
// So dR/d(angle) is the matrix of Table 2.1 times R_origin, and dC/dC stays I.
// With the identity as the origin, x is as in the thesis.
class LinearizationPoint {
 public:
  // The motion at x = 0; the identity by default.
  LinearizationPoint() : LinearizationPoint(Rigid3d()) {}
  explicit LinearizationPoint(const Rigid3d& cur_from_prev);

  // R and C at x[6].
  template <typename T>
  RotationAndCenter<T> PoseAt(const T* x) const {
    RotationAndCenter<T> pose;
    // R_ stays a matrix of doubles: a Jet times a Jet costs over twice as much.
    const Eigen::Matrix<T, 3, 3> turn = RotationFromAngles(x);
    for (int i = 0; i < 3; ++i) {
      Multiply(turn, R_.col(i).data(), pose.R.col(i).data());
      pose.C[i] = x[3 + i] + C_[i];
    }
    return pose;
  }

  // R, C and dR/d(alpha, beta, gamma) at x[6].
  MotionDerivatives DerivativesAt(const double* x) const;

  // As DerivativesAt, but cached until another x is requested: shared by the
  // residual blocks of a problem. Not thread-safe.
  const MotionDerivatives& CachedDerivativesAt(const double* x) const {
    const Eigen::Map<const MotionVector> at(x);
    if (at != shared_x_) {
      shared_ = DerivativesAt(x);
      shared_x_ = at;
    }
    return shared_;
  }

  // The motion at x[6].
  Rigid3d CurFromPrev(const double* x) const;

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector3d C_;
  mutable MotionVector shared_x_;  // x of shared_; NaN if there is none
  mutable MotionDerivatives shared_;
};

// R, C and the derivatives of a motion with respect to small changes of it.
MotionDerivatives DerivativesAt(const Rigid3d& cur_from_prev);

// A measured motion between two frames, used to correct their poses later.
struct RelativePose {
  int ref = 0;                                     // the reference frame
  int cur = 0;                                     // the other frame
  Rigid3d cur_from_ref;                            // as measured
  MotionMatrix covariance = MotionMatrix::Zero();  // as in MotionEstimate
};

// Covariance of c_from_b * b_from_a from those of both motions, which are
// independent; all of [omega C] as in MotionEstimate. Errors to first order:
//
//   omega = omega_cb + R_cb omega_ba
//   C     = C_ba + R_ba^T (C_cb + [position C_cb]x omega_ba)
MotionMatrix ComposedCovariance(const Rigid3d& c_from_b,
                                const MotionMatrix& covariance_cb,
                                const Rigid3d& b_from_a,
                                const MotionMatrix& covariance_ba);

// Squared distance between two motions in sigmas of a covariance of [omega C]
// as in MotionEstimate, which must be positive definite.
double SquaredMahalanobisDistance(const Rigid3d& cur_from_prev,
                                  const Rigid3d& other,
                                  const MotionMatrix& covariance);

// The six parameters of a motion (origin: the identity). |beta| <= pi/2; at
// beta = +-pi/2 alpha and gamma are not unique: one solution of them.
MotionVector MotionFromRigid(const Rigid3d& cur_from_prev);

}  // namespace rgbd_pose
