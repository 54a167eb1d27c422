#pragma once

#include <Eigen/Core>

#include "core/factors/blocks.h"
#include "core/geometry/motion.h"

// The motion from a frame `ref` to a frame `cur` as a function of their poses:
// cur_from_ref with
//
//   R = R_cur^T R_ref,   C = R_ref^T (p_cur - p_ref).
//
// Small changes of it are [omega C], R(omega) = Exp(omega) R, as in
// MotionEstimate.

namespace rgbd_pose {

template <typename T>
RotationAndCenter<T> MotionBetween(const PoseOf<T>& ref, const PoseOf<T>& cur) {
  return {(cur.q.conjugate() * ref.q).toRotationMatrix(),
          ref.q.conjugate() * Eigen::Matrix<T, 3, 1>(cur.p - ref.p)};
}

// The motion and its derivatives by [omega C].
inline MotionDerivatives WithDerivatives(
    const RotationAndCenter<double>& motion) {
  MotionDerivatives result;
  static_cast<RotationAndCenter<double>&>(result) = motion;
  for (int k = 0; k < 3; ++k) {
    result.dR[k] = CrossMatrix(Eigen::Vector3d::Unit(k)) * motion.R;
  }
  return result;
}

// d[omega C] / d(tangent of each pose).
struct MotionJacobians {
  MotionMatrix by_ref = MotionMatrix::Zero();
  MotionMatrix by_cur = MotionMatrix::Zero();

  MotionJacobians(const PoseOf<double>& ref,
                  const RotationAndCenter<double>& motion) {
    by_ref.topLeftCorner<3, 3>() = motion.R;
    by_ref.bottomLeftCorner<3, 3>() = CrossMatrix(motion.C);
    by_ref.bottomRightCorner<3, 3>() = -ref.R().transpose();
    by_cur.topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity();
    by_cur.bottomRightCorner<3, 3>() = ref.R().transpose();
  }
};

// The pose of a sensor that is mounted on a body.
template <typename T>
PoseOf<T> Mounted(const PoseOf<T>& body, const PoseOf<T>& body_from_sensor) {
  return {body.q * body_from_sensor.q, body.q * body_from_sensor.p + body.p};
}

// d(tangent of the sensor) / d(tangents of the body and of the mounting).
struct MountedJacobians {
  MotionMatrix by_body = MotionMatrix::Zero();
  MotionMatrix by_mounting = MotionMatrix::Identity();

  MountedJacobians(const PoseOf<double>& body,
                   const PoseOf<double>& body_from_sensor) {
    const Eigen::Matrix3d R = body.R();
    by_body.topLeftCorner<3, 3>() = body_from_sensor.R().transpose();
    by_body.bottomLeftCorner<3, 3>() = -R * CrossMatrix(body_from_sensor.p);
    by_body.bottomRightCorner<3, 3>().setIdentity();
    by_mounting.bottomRightCorner<3, 3>() = R;
  }
};

}  // namespace rgbd_pose
