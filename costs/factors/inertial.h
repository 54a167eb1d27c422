#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/factors/sampler.h"
#include "core/inertial/preintegration.h"

namespace rgbd_pose {

// The velocity of a body in the world, m/s.
struct VelocityBlock : VectorBlock<3> {
  static constexpr char kName[] = "velocity";  // for messages
};

// The biases of an inertial sensor, as ImuBiasVector.
struct ImuBiasBlock : VectorBlock<6> {
  static constexpr char kName[] = "bias";  // for messages
};

// What an inertial sensor measured between two poses of its own
// (world_from_sensor), with the velocities and the biases there,
//
//   r = S [ 2 vec q ; v - v_m ; p - p_m ; b_j - b_i ],
//
// with q the quaternion of R_m^T R, q_w >= 0. R, v and p are those of
// PreintegratedMotion for the states, R_m, v_m and p_m the measured ones,
// corrected to first order for what b_i differs from the bias that they were
// integrated with. If it moves far (gyroscope: 0.01 rad/s over a second),
// integrate again.
struct InertialFactor {
  static constexpr char kName[] = "inertial";
  using Blocks = BlockList<PoseBlock, VelocityBlock, ImuBiasBlock, PoseBlock,
                           VelocityBlock, ImuBiasBlock>;
  static constexpr int kRows = 15;
  // Velocities, biases and derivatives by a block.
  template <typename T>
  using Vector3 = Eigen::Matrix<T, 3, 1>;
  template <typename T>
  using Vector6 = Eigen::Matrix<T, 6, 1>;
  template <typename Block>
  using By = TangentJacobian<kRows, Block>;

  PreintegratedMotion motion;  // measured
  Eigen::Vector3d gravity;     // in the world: towards the ground, m/s^2
  PreintegratedMotion::Covariance sqrt_information;  // S

  // Throws InputError if the covariance of the motion is not positive definite.
  InertialFactor(const PreintegratedMotion& preintegrated,
                 const Eigen::Vector3d& gravity_in_world)
      : motion(preintegrated),
        gravity(gravity_in_world),
        sqrt_information(preintegrated.SqrtInformation()) {}

  template <typename T>
  bool Residual(const PoseOf<T>& i, const Vector3<T>& v_i,
                const Vector6<T>& b_i, const PoseOf<T>& j,
                const Vector3<T>& v_j, const Vector6<T>& b_j, T* r) const {
    const T t(motion.seconds);
    const Vector6<T> db = b_i - motion.bias.cast<T>();
    const Eigen::Matrix<T, 9, 1> correction = motion.by_bias.cast<T>() * db;
    const Eigen::Quaternion<T> R_m =
        motion.start_from_end.cast<T>() *
        RotationBy(Vector3<T>(correction.template head<3>()));
    const Eigen::Quaternion<T> to_i = i.q.conjugate();
    const Vector3<T> g = gravity.cast<T>();
    Eigen::Matrix<T, kRows, 1> e;
    e << RotationError(Eigen::Quaternion<T>(R_m.conjugate() * (to_i * j.q))),
        to_i * Vector3<T>(v_j - v_i - t * g) - motion.v.cast<T>() -
            correction.template segment<3>(3),
        to_i * Vector3<T>(j.p - i.p - t * v_i - T(0.5) * t * t * g) -
            motion.p.cast<T>() - correction.template tail<3>(),
        b_j - b_i;
    Eigen::Map<Eigen::Matrix<T, kRows, 1>> whitened(r);
    whitened = sqrt_information.cast<T>() * e;
    return true;
  }

  bool Jacobian(const PoseOf<double>& i, const Eigen::Vector3d& v_i,
                const ImuBiasVector& b_i, const PoseOf<double>& j,
                const Eigen::Vector3d& v_j, const ImuBiasVector& b_j, double* r,
                By<PoseBlock>* by_i, By<VelocityBlock>* by_v_i,
                By<ImuBiasBlock>* by_b_i, By<PoseBlock>* by_j,
                By<VelocityBlock>* by_v_j, By<ImuBiasBlock>* by_b_j) const {
    const double t = motion.seconds;
    const Eigen::Matrix<double, 9, 1> correction =
        motion.by_bias * (b_i - motion.bias);
    const Eigen::Vector3d turn = correction.head<3>();
    const Eigen::Quaterniond R_m = motion.start_from_end * RotationBy(turn);
    const Eigen::Quaterniond q = R_m.conjugate() * (i.q.conjugate() * j.q);
    const Eigen::Matrix3d to_i = i.R().transpose();
    const Eigen::Vector3d v = to_i * (v_j - v_i - t * gravity);
    const Eigen::Vector3d p =
        to_i * (j.p - i.p - t * v_i - 0.5 * t * t * gravity);
    Eigen::Matrix<double, kRows, 1> e;
    e << RotationError(q), v - motion.v - correction.segment<3>(3),
        p - motion.p - correction.tail<3>(), b_j - b_i;
    Eigen::Map<Eigen::Matrix<double, kRows, 1>>(r, kRows) =
        sqrt_information * e;

    // R_m Exp(a) and R_i Exp(b) turn q from the left by -a and by -R_m^T b.
    const Eigen::Matrix3d by_left = RotationErrorJacobian(q);
    const auto& S = sqrt_information;
    const auto S_omega = S.leftCols<3>();
    const auto S_v = S.middleCols<3>(3);
    const auto S_p = S.middleCols<3>(6);
    by_i->leftCols<3>() =
        S_omega * (-by_left * R_m.toRotationMatrix().transpose()) +
        S_v * CrossMatrix(v) + S_p * CrossMatrix(p);
    by_j->leftCols<3>() = S_omega * RotationErrorJacobian(q).transpose();
    by_j->rightCols<3>() = S_p * to_i;
    by_i->rightCols<3>() = -by_j->rightCols<3>();
    *by_v_j = S_v * to_i;
    *by_v_i = -*by_v_j - t * by_j->rightCols<3>();
    *by_b_j = S.rightCols<6>();
    Eigen::Matrix<double, 9, 6> e_by_bias = -motion.by_bias;
    e_by_bias.topRows<3>() =
        -by_left * RotationByJacobian(turn) * motion.by_bias.topRows<3>();
    *by_b_i = S.leftCols<9>() * e_by_bias - *by_b_j;
    return true;
  }

  // Half a second of any motion.
  static InertialFactor Sample(FactorSampler* random) {
    std::vector<ImuSample> samples;
    for (int k = 0; k <= 10; ++k) {
      samples.push_back(
          {0.05 * k, random->Vector<3>(1.0), random->Vector<3>(10.0)});
    }
    const ImuNoise coarse = {0.3, 0.5, 0.4, 0.6};
    return {Preintegrate(samples, random->Vector<6>(0.5), coarse),
            random->Vector<3>(10.0)};
  }
};

}  // namespace rgbd_pose
