#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/rigid3.h"

// Parts of factors on rotations: small turns, and the error 2 vec q of a
// rotation, which is its rotation vector to first order and increases up to
// half a turn.

namespace rgbd_pose {

// The quaternion with q_w >= 0 of the same rotation.
template <typename T>
Eigen::Quaternion<T> Shorter(Eigen::Quaternion<T> q) {
  if (q.w() < T(0.0)) q.coeffs() = -q.coeffs();
  return q;
}

// 2 vec q, of the shorter quaternion.
template <typename T>
Eigen::Matrix<T, 3, 1> RotationError(const Eigen::Quaternion<T>& q) {
  return T(2.0) * Shorter(q).vec();
}

// d(2 vec q) / d omega of Exp(omega) q and of q Exp(omega).
inline Eigen::Matrix3d RotationErrorByLeft(const Eigen::Quaterniond& q) {
  return q.w() * Eigen::Matrix3d::Identity() - CrossMatrix(q.vec());
}
inline Eigen::Matrix3d RotationErrorByRight(const Eigen::Quaterniond& q) {
  return q.w() * Eigen::Matrix3d::Identity() + CrossMatrix(q.vec());
}

// The rotation along omega whose half angle has the tangent |omega| / 2. It is
// Exp(omega) but for a term of third order, and, unlike Exp, it and its
// derivatives need no special case at 0.
template <typename T>
Eigen::Quaternion<T> SmallTurn(const Eigen::Matrix<T, 3, 1>& omega) {
  return Eigen::Quaternion<T>(T(1.0), T(0.5) * omega[0], T(0.5) * omega[1],
                              T(0.5) * omega[2])
      .normalized();
}

// J with SmallTurn(omega + d) = SmallTurn(omega) Exp(J d) to first order.
inline Eigen::Matrix3d SmallTurnJacobian(const Eigen::Vector3d& omega) {
  return (Eigen::Matrix3d::Identity() - 0.5 * CrossMatrix(omega)) /
         (1.0 + 0.25 * omega.squaredNorm());
}

}  // namespace rgbd_pose
