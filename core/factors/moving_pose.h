#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

// Where a body is a short time after its pose was taken: a rolling shutter
// exposes each row of an image at another pose. With the velocity [omega v] in
// the body's own axes, which is kept,
//
//   R(t) = R Exp(t omega),   p(t) = p + R (t v + t^2 / 2 omega x v)
//
// to second order in t for the position, as in Twist::MovePoint.

namespace rgbd_pose {

// The pose `seconds` later (negative: earlier), for fractions of a second; the
// twist is that of a TwistBlock.
template <typename T>
PoseOf<T> PoseAfter(const PoseOf<T>& pose, const Eigen::Matrix<T, 6, 1>& twist,
                    double seconds) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const Vector omega = twist.template head<3>(), v = twist.template tail<3>();
  const Vector turn = T(seconds) * omega;
  const Vector shift = T(seconds) * (v + T(0.5) * turn.cross(v));
  return {pose.q * RotationBy(turn), pose.p + pose.q * shift};
}

// d(tangent of the later pose) / d(tangent of the pose, and the twist).
struct PoseAfterJacobians {
  MotionMatrix by_pose = MotionMatrix::Identity();  // by [omega p]
  MotionMatrix by_twist = MotionMatrix::Zero();     // by [omega v]

  // Those of PoseAfter with the same arguments.
  PoseAfterJacobians(const PoseOf<double>& pose,
                     const Eigen::Matrix<double, 6, 1>& twist, double seconds) {
    const Eigen::Matrix3d R = pose.R();
    const Eigen::Vector3d turn = seconds * twist.head<3>();
    const Eigen::Vector3d v = twist.tail<3>();
    const Eigen::Vector3d shift = seconds * (v + 0.5 * turn.cross(v));
    by_pose.topLeftCorner<3, 3>() =
        RotationBy(turn).toRotationMatrix().transpose();
    by_pose.bottomLeftCorner<3, 3>() = -R * CrossMatrix(shift);
    by_twist.topLeftCorner<3, 3>() = seconds * RotationByJacobian(turn);
    by_twist.bottomLeftCorner<3, 3>() =
        -0.5 * seconds * seconds * R * CrossMatrix(v);
    by_twist.bottomRightCorner<3, 3>() =
        seconds * R * (Eigen::Matrix3d::Identity() + 0.5 * CrossMatrix(turn));
  }
};

}  // namespace rgbd_pose
