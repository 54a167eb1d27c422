#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/factors/sampler.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A measured motion between two poses, for instance a MotionEstimate,
//
//   r = S [ 2 vec q ; C - C_m ],   q the quaternion of R R_m^T,  q_w >= 0,
//
// where R = R_cur^T R_ref turns the axes of `ref` into those of `cur` and C =
// R_ref^T (p_cur - p_ref) is the position of `cur` in the axes of `ref`. To
// first order 2 vec q is omega in Exp(omega) = R R_m^T; it increases up to half
// a turn, as omega does (core/factors/rotations.h).
struct RelativePoseFactor {
  static constexpr char kName[] = "relative_pose";
  using Blocks = BlockList<PoseBlock, PoseBlock>;
  static constexpr int kRows = 6;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  Rigid3d cur_from_ref;  // as measured

  // S, with S^T S the inverse of the covariance of [omega C]: its order and
  // axes are those of MotionEstimate::covariance
  // (core/factors/sqrt_information.h).
  MotionMatrix sqrt_information;

  template <typename T>
  bool Residual(const PoseOf<T>& ref, const PoseOf<T>& cur, T* r) const {
    const Eigen::Quaternion<T> ref_from_cur_measured =
        cur_from_ref.rotation.conjugate().template cast<T>();
    const Eigen::Quaternion<T> q =
        cur.q.conjugate() * ref.q * ref_from_cur_measured;
    const Eigen::Matrix<T, 3, 1> C =
        ref.q.conjugate() * Eigen::Matrix<T, 3, 1>(cur.p - ref.p);
    Eigen::Matrix<T, 6, 1> e;
    e << RotationError(q), C - MeasuredC().template cast<T>();
    Eigen::Map<Eigen::Matrix<T, 6, 1>> whitened(r);
    whitened = sqrt_information.template cast<T>() * e;
    return true;
  }

  bool Jacobian(const PoseOf<double>& ref, const PoseOf<double>& cur, double* r,
                ByPose* by_ref, ByPose* by_cur) const {
    const Eigen::Matrix3d ref_from_world = ref.R().transpose();
    const Eigen::Quaterniond turn = cur.q.conjugate() * ref.q;
    const Eigen::Quaterniond q = turn * cur_from_ref.rotation.conjugate();
    const Eigen::Vector3d C = ref_from_world * (cur.p - ref.p);
    MotionVector e;
    e << RotationError(q), C - MeasuredC();
    Eigen::Map<MotionVector>(r, 6) = sqrt_information * e;
    // R becomes Exp(R omega_ref - omega_cur) R.
    const Eigen::Matrix3d by_omega = RotationErrorJacobian(q);
    by_ref->leftCols<3>() =
        sqrt_information.leftCols<3>() * (by_omega * turn.toRotationMatrix()) +
        sqrt_information.rightCols<3>() * CrossMatrix(C);
    by_cur->leftCols<3>() = -sqrt_information.leftCols<3>() * by_omega;
    by_cur->rightCols<3>() = sqrt_information.rightCols<3>() * ref_from_world;
    by_ref->rightCols<3>() = -by_cur->rightCols<3>();
    return true;
  }

  static RelativePoseFactor Sample(FactorSampler* random) {
    return {random->Motion(), random->SqrtInformation<6>()};
  }

 private:
  // The measured position of `cur` in the axes of `ref`.
  Eigen::Vector3d MeasuredC() const {
    return -(cur_from_ref.rotation.conjugate() * cur_from_ref.translation);
  }
};

}  // namespace rgbd_pose
