#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/factors/sampler.h"
#include "core/factors/sqrt_information.h"
#include "core/inertial/preintegration.h"

namespace rgbd_pose {

// The bias of a gyroscope, rad/s.
struct GyroscopeBiasBlock : VectorBlock<3> {
  static constexpr char kName[] = "bias";  // for messages
};

// What a gyroscope alone measured between two poses of the sensor
// (world_from_sensor), with its bias (rad/s) in between,
//
//   r = S 2 vec q,   q the quaternion of R_m^T R_i^T R_j,  q_w >= 0.
//
// R_m is corrected to first order for what the bias differs from that of the
// integration. The bias is one block: its walk is not part of this factor.
struct GyroscopeFactor {
  static constexpr char kName[] = "gyroscope";
  using Blocks = BlockList<PoseBlock, PoseBlock, GyroscopeBiasBlock>;
  static constexpr int kRows = 3;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  Eigen::Quaterniond i_from_j;       // R_m
  Eigen::Vector3d integrated_bias;   // the bias taken off, rad/s
  Eigen::Matrix3d by_bias;           // d omega / d bias, R_m Exp(omega), s
  Eigen::Matrix3d sqrt_information;  // S, 1/rad

  // Takes the rotation of a motion; its accelerations are of no importance.
  // Throws InputError if its covariance is not positive definite.
  explicit GyroscopeFactor(const PreintegratedMotion& motion)
      : i_from_j(motion.start_from_end),
        integrated_bias(motion.bias.head<3>()),
        by_bias(motion.by_bias.topLeftCorner<3, 3>()),
        sqrt_information(SqrtInformationOfCovariance(
            motion.covariance.topLeftCorner<3, 3>())) {}

  template <typename T>
  bool Residual(const PoseOf<T>& i, const PoseOf<T>& j,
                const Eigen::Matrix<T, 3, 1>& bias, T* r) const {
    const Eigen::Matrix<T, 3, 1> turn =
        by_bias.cast<T>() *
        Eigen::Matrix<T, 3, 1>(bias - integrated_bias.cast<T>());
    const Eigen::Quaternion<T> R_m = i_from_j.cast<T>() * RotationBy(turn);
    const Eigen::Quaternion<T> q = R_m.conjugate() * (i.q.conjugate() * j.q);
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = sqrt_information.cast<T>() * RotationError(q);
    return true;
  }

  bool Jacobian(const PoseOf<double>& i, const PoseOf<double>& j,
                const Eigen::Vector3d& bias, double* r, ByPose* by_i,
                ByPose* by_j,
                TangentJacobian<kRows, GyroscopeBiasBlock>* by_b) const {
    const Eigen::Vector3d turn = by_bias * (bias - integrated_bias);
    const Eigen::Quaterniond R_m = i_from_j * RotationBy(turn);
    const Eigen::Quaterniond q = R_m.conjugate() * (i.q.conjugate() * j.q);
    Eigen::Map<Eigen::Vector3d>(r, 3) = sqrt_information * RotationError(q);
    // R_m Exp(a) and R_i Exp(b) turn q from the left by -a and by -R_m^T b.
    const Eigen::Matrix3d by_left =
        -sqrt_information * RotationErrorJacobian(q);
    by_i->setZero();
    by_i->leftCols<3>() = by_left * R_m.toRotationMatrix().transpose();
    by_j->setZero();
    by_j->leftCols<3>() =
        sqrt_information * RotationErrorJacobian(q).transpose();
    *by_b = by_left * RotationByJacobian(turn) * by_bias;
    return true;
  }

  static GyroscopeFactor Sample(FactorSampler* random) {
    PreintegratedMotion motion;
    motion.start_from_end = random->Motion().rotation;
    motion.bias = random->Vector<6>(0.5);
    for (double& value : motion.by_bias.reshaped()) {
      value = random->Uniform(-0.5, 0.5);
    }
    const Eigen::Matrix3d S = random->SqrtInformation<3>();
    motion.covariance.topLeftCorner<3, 3>() = S * S.transpose();
    return GyroscopeFactor(motion);
  }
};

}  // namespace rgbd_pose
