#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/factors/blocks.h"
#include "core/factors/rotations.h"
#include "core/factors/sampler.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A body that keeps its velocity but for white noise of its acceleration,
// between the times of two poses; velocities are in the body's own axes
// (TwistBlock). With dt = seconds and R = R_a^T R_b,
//
//   e_1 = [ 2 vec q ; R_a^T (p_b - p_a) - dt v_a ]     q of Exp(-dt omega_a) R
//   e_2 = [ omega_b - omega_a ; R v_b - v_a ]
//   r   = S [ e_1 ; e_2 ]
//
// The angular velocity is kept in the axes of the body, the linear velocity in
// those of the world, as without forces. White noise of density s, integrated
// once and twice, gives the covariance of both errors in each axis (Bar-Shalom
// et al., Estimation with Applications to Tracking and Navigation, 2001;
// Barfoot, State Estimation for Robotics, 2017),
//
//   s^2 [ dt^3 / 3, dt^2 / 2 ; dt^2 / 2, dt ],
//
// whose inverse is S^T S with S = [ sqrt(3 / dt^3), 0 ; -3 / sqrt(dt^3),
// 2 / sqrt(dt) ] / s. Rotations of e_1 and of its noise are told apart to first
// order only: their error should be well below 1 rad.
struct ConstantVelocityFactor {
  static constexpr char kName[] = "constant_velocity";
  using Blocks = BlockList<PoseBlock, TwistBlock, PoseBlock, TwistBlock>;
  static constexpr int kRows = 12;
  using ByPose = TangentJacobian<kRows, PoseBlock>;
  using ByTwist = TangentJacobian<kRows, TwistBlock>;

  double seconds = 0.1;  // from pose a to pose b, > 0

  // Densities of the noise: how much the velocities change in a second.
  double angular_density = 1.0;  // rad/s^2/sqrt(Hz)
  double linear_density = 1.0;   // m/s^2/sqrt(Hz)

  template <typename T>
  bool Residual(const PoseOf<T>& a, const Eigen::Matrix<T, 6, 1>& twist_a,
                const PoseOf<T>& b, const Eigen::Matrix<T, 6, 1>& twist_b,
                T* r) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Quaternion<T> a_from_world = a.q.conjugate();
    const Eigen::Quaternion<T> turn = a_from_world * b.q;
    const Vector kept = T(-seconds) * twist_a.template head<3>();
    Eigen::Matrix<T, 6, 1> first, second;
    first << RotationError(Eigen::Quaternion<T>(RotationBy(kept) * turn)),
        a_from_world * Vector(b.p - a.p) -
            T(seconds) * twist_a.template tail<3>();
    second << twist_b.template head<3>() - twist_a.template head<3>(),
        turn * Vector(twist_b.template tail<3>()) - twist_a.template tail<3>();
    Whiten(first, second, r);
    return true;
  }

  bool Jacobian(const PoseOf<double>& a,
                const Eigen::Matrix<double, 6, 1>& twist_a,
                const PoseOf<double>& b,
                const Eigen::Matrix<double, 6, 1>& twist_b, double* r,
                ByPose* by_a, ByTwist* by_twist_a, ByPose* by_b,
                ByTwist* by_twist_b) const {
    Residual(a, twist_a, b, twist_b, r);
    const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d a_from_world = a.R().transpose();
    const Eigen::Quaterniond turn = a.q.conjugate() * b.q;
    const Eigen::Matrix3d R = turn.toRotationMatrix();
    const Eigen::Vector3d kept = -seconds * twist_a.head<3>();
    const Eigen::Vector3d v_b = twist_b.tail<3>();
    const Eigen::Quaterniond turned = RotationBy(kept);
    // q becomes Exp(turned (J(kept) d kept - omega_a)) q Exp(omega_b), where
    // Exp(kept + d) = Exp(kept) Exp(J d).
    const Eigen::Matrix3d by_left =
        RotationErrorJacobian(turned * turn) * turned.toRotationMatrix();
    const Eigen::Matrix3d by_right =
        RotationErrorJacobian(turned * turn).transpose();
    MotionMatrix first, second;
    const auto give = [&](auto* by) {
      for (int k = 0; k < 6; ++k) {
        Eigen::Matrix<double, kRows, 1> column;
        Whiten<double>(first.col(k), second.col(k), column.data());
        by->col(k) = column;
      }
      first.setZero();
      second.setZero();
    };
    first.setZero();
    second.setZero();

    first.topLeftCorner<3, 3>() = -by_left;
    first.bottomLeftCorner<3, 3>() = CrossMatrix(a_from_world * (b.p - a.p));
    first.bottomRightCorner<3, 3>() = -a_from_world;
    second.bottomLeftCorner<3, 3>() = CrossMatrix(R * v_b);
    give(by_a);

    first.topLeftCorner<3, 3>() = -seconds * by_left * RotationByJacobian(kept);
    first.bottomRightCorner<3, 3>() = -seconds * I;
    second = -MotionMatrix::Identity();
    give(by_twist_a);

    first.topLeftCorner<3, 3>() = by_right;
    first.bottomRightCorner<3, 3>() = a_from_world;
    second.bottomLeftCorner<3, 3>() = -R * CrossMatrix(v_b);
    give(by_b);

    second.topLeftCorner<3, 3>() = I;
    second.bottomRightCorner<3, 3>() = R;
    give(by_twist_b);
    return true;
  }

  static ConstantVelocityFactor Sample(FactorSampler* random) {
    return {random->Uniform(0.05, 2.0), random->Uniform(0.1, 2.0),
            random->Uniform(0.1, 2.0)};
  }

 private:
  // r[12] = S [ first ; second ].
  template <typename T>
  void Whiten(const Eigen::Matrix<T, 6, 1>& first,
              const Eigen::Matrix<T, 6, 1>& second, T* r) const {
    const double root = std::sqrt(seconds);
    for (int k = 0; k < 6; ++k) {
      const double density = k < 3 ? angular_density : linear_density;
      const T once = second[k] * (1.0 / (root * density));
      const T twice = first[k] * (1.0 / (root * seconds * density));
      r[k] = std::sqrt(3.0) * twice;
      r[6 + k] = 2.0 * once - 3.0 * twice;
    }
  }
};

}  // namespace rgbd_pose
