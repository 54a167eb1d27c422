#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/rigid3.h"

// Rotations in residuals: errors of rotations, and rotations by velocities,
// with what their Jacobians need.

namespace rgbd_pose {

// The error 2 vec q of a rotation q that should be the identity, for q_w >= 0
// (-q is the same rotation). To first order it is the rotation vector; its
// length is 2 sin(angle / 2), which increases up to half a turn.
template <typename T>
Eigen::Matrix<T, 3, 1> RotationError(const Eigen::Quaternion<T>& q) {
  return T(q.w() < T(0.0) ? -2.0 : 2.0) * q.vec();
}

// Its derivative by omega at 0, where Exp(omega) q takes the place of q. For
// q Exp(omega) it is the transpose.
inline Eigen::Matrix3d RotationErrorJacobian(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return sign * (q.w() * Eigen::Matrix3d::Identity() - CrossMatrix(q.vec()));
}

// Exp(omega), the rotation by a rotation vector (rad) of any length, as a
// quaternion of any scalar.
template <typename T>
Eigen::Quaternion<T> RotationBy(const Eigen::Matrix<T, 3, 1>& omega) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T squared = omega.squaredNorm();
  T w, scale;
  // The series are exact to rounding below this, and smooth at 0, where the
  // root is not.
  if (squared < T(1e-6)) {
    w = T(1.0) - squared / T(8.0) + squared * squared / T(384.0);
    scale = T(0.5) - squared / T(48.0);
  } else {
    const T angle = sqrt(squared);
    w = cos(T(0.5) * angle);
    scale = sin(T(0.5) * angle) / angle;
  }
  return {w, scale * omega.x(), scale * omega.y(), scale * omega.z()};
}

// The right Jacobian of Exp: Exp(omega + d) = Exp(omega) Exp(J d) to first
// order in d (Chirikjian, Stochastic Models, Information Theory, and Lie
// Groups, 2012),
//
//   J = I - (1 - cos a) / a^2 [omega]x + (a - sin a) / a^3 [omega]x^2.
inline Eigen::Matrix3d RotationByJacobian(const Eigen::Vector3d& omega) {
  const double squared = omega.squaredNorm();
  double first = 0.0, second = 0.0;
  if (squared < 1e-4) {
    first = 0.5 - squared / 24.0 + squared * squared / 720.0;
    second = 1.0 / 6.0 - squared / 120.0;
  } else {
    const double angle = std::sqrt(squared);
    const double half = std::sin(0.5 * angle);
    first = 2.0 * half * half / squared;
    second = (angle - std::sin(angle)) / (squared * angle);
  }
  const Eigen::Matrix3d cross = CrossMatrix(omega);
  return Eigen::Matrix3d::Identity() - first * cross + second * cross * cross;
}

}  // namespace rgbd_pose
