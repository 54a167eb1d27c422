#pragma once

#include <Eigen/Core>

#include "core/geometry/motion.h"
#include "costs/parts/cost_input.h"
#include "costs/parts/moved_point.h"
#include "costs/parts/whitening.h"

namespace rgbd_pose {

// The 3D error of a match in current axes, e = X_cur - R (X_prev - C), in
// metres, before whitening.
struct ForwardError {
  static constexpr int kColumns = 6;  // X_prev, X_cur

  // Writes the columns of match i; returns false if a depth is missing.
  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Correspondences& matches = input.matches;
    const Observation& prev = matches[i].prev;
    const Observation& cur = matches[i].cur;
    if (prev.depth <= 0.0 || cur.depth <= 0.0) return false;
    Eigen::Map<Eigen::Vector3d> x_prev(columns), x_cur(columns + 3);
    x_prev = matches.Point(prev);
    x_cur = matches.Point(cur);
    return true;
  }

  // Covariance of e (m^2) at the bound motion: S_cur + R S_prev R^T.
  static Eigen::Matrix3d Covariance(const CostInput& input, size_t i) {
    const Camera& camera = input.matches.camera();
    const Eigen::Matrix3d R = input.cur_from_prev.rotation.toRotationMatrix();
    return PointCovariance(camera, input.matches[i].cur) +
           R * PointCovariance(camera, input.matches[i].prev) * R.transpose();
  }

  // e (m), from the columns of a match.
  template <typename M, typename D, typename T>
  static void Error(const RotationAndCenter<M>& motion, const D* columns,
                    T* e) {
    T q[3];
    Forward::TransformPoint(motion, columns, q);
    for (int i = 0; i < 3; ++i) e[i] = columns[3 + i] - q[i];
  }

  // de / d x[parameter] = -dq / d x[parameter].
  template <typename D>
  static void Derivative(const MotionDerivatives& motion, const D* columns,
                         int parameter, D* de) {
    Forward::Derivative(motion, columns, parameter, de);
    for (int i = 0; i < 3; ++i) de[i] = -de[i];
  }
};

}  // namespace rgbd_pose
