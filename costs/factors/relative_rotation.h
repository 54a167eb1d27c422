#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/factors/sampler.h"

namespace rgbd_pose {

// A measured rotation between two poses, for instance of a gyroscope,
//
//   r = S 2 vec q,   q the quaternion of R R_m^T,  q_w >= 0,
//
// where R = R_cur^T R_ref turns the axes of `ref` into those of `cur`: the
// first rows of RelativePoseFactor.
struct RelativeRotationFactor {
  static constexpr char kName[] = "relative_rotation";
  using Blocks = BlockList<PoseBlock, PoseBlock>;
  static constexpr int kRows = 3;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  Eigen::Quaterniond cur_from_ref;  // as measured, of length 1

  // S, with S^T S the inverse of the covariance of omega (rad^2) in
  // Exp(omega) = R R_m^T, which is about the axes of `cur`.
  Eigen::Matrix3d sqrt_information;

  template <typename T>
  bool Residual(const PoseOf<T>& ref, const PoseOf<T>& cur, T* r) const {
    const Eigen::Quaternion<T> q =
        cur.q.conjugate() * ref.q * cur_from_ref.conjugate().template cast<T>();
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = sqrt_information.template cast<T>() * RotationError(q);
    return true;
  }

  bool Jacobian(const PoseOf<double>& ref, const PoseOf<double>& cur, double* r,
                ByPose* by_ref, ByPose* by_cur) const {
    Residual(ref, cur, r);
    // R becomes Exp(R omega_ref - omega_cur) R.
    const Eigen::Quaterniond turn = cur.q.conjugate() * ref.q;
    const Eigen::Matrix3d by_omega =
        sqrt_information *
        RotationErrorJacobian(turn * cur_from_ref.conjugate());
    by_ref->setZero();
    by_cur->setZero();
    by_ref->leftCols<3>() = by_omega * turn.toRotationMatrix();
    by_cur->leftCols<3>() = -by_omega;
    return true;
  }

  static RelativeRotationFactor Sample(FactorSampler* random) {
    return {random->Motion().rotation, random->SqrtInformation<3>()};
  }
};

}  // namespace rgbd_pose
