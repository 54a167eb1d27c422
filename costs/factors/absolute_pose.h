#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/factors/sampler.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A measured pose, from a map, a motion capture system or an earlier estimate,
//
//   r = S [ 2 vec q ; p - p_m ],   q the quaternion of R_m^T R,  q_w >= 0,
//
// where R turns the axes of the body into those of the world and p (m) is the
// body's position there.
struct AbsolutePoseFactor {
  static constexpr char kName[] = "absolute_pose";
  using Blocks = BlockList<PoseBlock>;
  static constexpr int kRows = 6;

  Rigid3d world_from_body;  // as measured

  // S, with S^T S the inverse of the covariance of [omega p] in the tangent of
  // the pose, about the body's and along the world's axes: as
  // ceres::Covariance reports it on a PoseManifold.
  MotionMatrix sqrt_information;

  template <typename T>
  bool Residual(const PoseOf<T>& pose, T* r) const {
    Eigen::Matrix<T, 6, 1> e;
    e << RotationError(Eigen::Quaternion<T>(
        world_from_body.rotation.conjugate().template cast<T>() * pose.q)),
        pose.p - world_from_body.translation.template cast<T>();
    Eigen::Map<Eigen::Matrix<T, 6, 1>> whitened(r);
    whitened = sqrt_information.template cast<T>() * e;
    return true;
  }

  bool Jacobian(const PoseOf<double>& pose, double* r,
                TangentJacobian<kRows, PoseBlock>* by_pose) const {
    Residual(pose, r);
    const Eigen::Quaterniond q = world_from_body.rotation.conjugate() * pose.q;
    by_pose->leftCols<3>() =
        sqrt_information.leftCols<3>() * RotationErrorJacobian(q).transpose();
    by_pose->rightCols<3>() = sqrt_information.rightCols<3>();
    return true;
  }

  static AbsolutePoseFactor Sample(FactorSampler* random) {
    return {random->Motion(), random->SqrtInformation<6>()};
  }
};

}  // namespace rgbd_pose
