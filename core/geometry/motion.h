#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "core/geometry/rigid3.h"
#include "core/util/lane_math.h"

// The motion between two frames in the six parameters of Lu (Tamkang 2016), as
// far as the public record fixes them (docs/jacobian_tables.md):
//
//   x = [alpha beta gamma Cx Cy Cz]   (rad, m)
//   X_cur = R (X_prev - C),  R = Rz(gamma) Ry(beta) Rx(alpha)
//
// R turns axes of the previous camera into axes of the current one; C is the
// centre of the current camera in the axes of the previous camera.

namespace rgbd_pose {

// The six parameters, and what is quadratic in them.
using MotionVector = Eigen::Matrix<double, 6, 1>;
using MotionMatrix = Eigen::Matrix<double, 6, 6>;

// R and C of a motion, for any scalar (double or ceres::Jet).
template <typename T>
struct RotationAndCenter {
  Eigen::Matrix<T, 3, 3> R;  // previous axes to current axes
  Eigen::Matrix<T, 3, 1> C;  // current centre in the previous frame, m
};

// R, C and the three matrices dR/d(alpha, beta, gamma) (Table 2.1). What a
// hand-written Jacobian needs, computed once per motion. dR/dC = 0 and
// dC/dC = I are not stored.
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

// The solver's parameters count from an origin, the initial guess, so that
// they stay small: no gimbal lock occurs and no manifold is needed.
//
//   R(x) = Rz Ry Rx(angles) R_origin,   C(x) = C_origin + [Cx Cy Cz]
//
// So dR/d(angle) is that of Table 2.1 times R_origin, and dC/dC stays I: the
// tables hold as they are. The identity as the origin gives the thesis' x.
class LinearizationPoint {
 public:
  // The motion at x = 0; by default none.
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

  // The same, kept until another x is asked for: what many residual blocks of
  // one problem share (Table 2.1). For one thread at a time.
  const MotionDerivatives& CachedDerivativesAt(const double* x) const {
    const Eigen::Map<const MotionVector> at(x);
    if (at != shared_x_) Share(x);
    return shared_;
  }

  // The motion at x[6].
  Rigid3d CurFromPrev(const double* x) const;

 private:
  void Share(const double* x) const;

  Eigen::Matrix3d R_;
  Eigen::Vector3d C_;
  mutable MotionVector shared_x_;  // of shared_; NaN: of none
  mutable MotionDerivatives shared_;
};

// Covariance of c_from_b * b_from_a, from those of the two independent motions;
// all of [omega C] as MotionEstimate has them, to first order:
//
//   omega = omega_cb + R_cb omega_ba
//   C     = C_ba + R_ba^T (C_cb + [C_cb]x omega_ba)     (errors; C_cb a place)
MotionMatrix ComposedCovariance(const Rigid3d& c_from_b,
                                const MotionMatrix& covariance_cb,
                                const Rigid3d& b_from_a,
                                const MotionMatrix& covariance_ba);

// How far a motion is from another one, squared, in sigmas of a covariance of
// [omega C] as MotionEstimate has it, which is positive definite.
double SquaredMahalanobisDistance(const Rigid3d& cur_from_prev,
                                  const Rigid3d& other,
                                  const MotionMatrix& covariance);

// The thesis' six parameters of a motion and back (origin: the identity).
// |beta| <= pi/2; at beta = +-pi/2 alpha and gamma are not unique, and the
// vector returned is one that gives the motion back.
MotionVector MotionFromRigid(const Rigid3d& cur_from_prev);
Rigid3d RigidFromMotion(const MotionVector& x);

}  // namespace rgbd_pose
