#pragma once

#include <ceres/cost_function.h>
#include <ceres/jet.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

// The motion between two poses that are both estimated. A pose is itself a
// motion, from the world to the camera, in the parameters of
// core/geometry/motion.h about its own origin:
//
//   x = [alpha beta gamma Cx Cy Cz],  X_cam = R (X_world - C)
//
// Hence C is the centre of the camera in the world. Between the cameras `ref`
// and `cur`:
//
//   R = R_cur R_ref^T,   C = R_ref (C_cur - C_ref)

namespace rgbd_pose {

using PosePairJacobian = Eigen::Matrix<double, 6, 12, Eigen::RowMajor>;

// [v]x, with [v]x w = v x w.
inline Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// For any scalar type: tests differentiate it to check RelativeMotionAt.
template <typename T>
RotationAndCenter<T> MotionBetween(const RotationAndCenter<T>& ref,
                                   const RotationAndCenter<T>& cur) {
  RotationAndCenter<T> motion;
  motion.R = cur.R * ref.R.transpose();
  const Eigen::Matrix<T, 3, 1> shift = cur.C - ref.C;
  motion.C = ref.R * shift;
  return motion;
}

// The rotation about the axes of the camera (rad) caused by small changes of
// the angles (rad) at x: the columns of d omega / d[alpha beta gamma].
inline Eigen::Matrix3d EulerRateJacobian(const double* x) {
  const double sb = std::sin(x[1]), cb = std::cos(x[1]);
  const double sg = std::sin(x[2]), cg = std::cos(x[2]);
  Eigen::Matrix3d axes;
  axes << cb * cg, -sg, 0, cb * sg, cg, 0, -sb, 0, 1;
  return axes;
}

// The motion between two poses and its derivatives.
struct RelativeMotion {
  RotationAndCenter<double> motion;
  // d[omega C] / d[x_ref x_cur]; omega (rad) is a small rotation about the axes
  // of `cur`, as in the covariance of MotionEstimate.
  PosePairJacobian jacobian;
};

inline RelativeMotion RelativeMotionAt(const LinearizationPoint& ref_origin,
                                       const double* x_ref,
                                       const LinearizationPoint& cur_origin,
                                       const double* x_cur) {
  const RotationAndCenter<double> ref = ref_origin.PoseAt(x_ref);
  RelativeMotion pair;
  pair.motion = MotionBetween(ref, cur_origin.PoseAt(x_cur));
  const Eigen::Matrix3d axes = EulerRateJacobian(x_ref);
  pair.jacobian.setZero();
  pair.jacobian.block<3, 3>(0, 0) = -pair.motion.R * axes;
  pair.jacobian.block<3, 3>(0, 6) = EulerRateJacobian(x_cur);
  pair.jacobian.block<3, 3>(3, 0) = -CrossMatrix(pair.motion.C) * axes;
  pair.jacobian.block<3, 3>(3, 3) = -ref.R;
  pair.jacobian.block<3, 3>(3, 9) = ref.R;
  return pair;
}

}  // namespace rgbd_pose
