#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/inertial/imu_sample.h"

// Inertial samples between two moments, summed up once: what they say of the
// motion, whatever the pose, the velocity and gravity at the start are.
// Forster, Carlone, Dellaert & Scaramuzza, "On-manifold preintegration for
// real-time visual-inertial odometry", T-RO 2017; with the biases' walk in the
// covariance.

namespace rgbd_pose {

// How an inertial sensor moved from a start to an end, in the axes that it had
// at the start. For poses world_from_body, velocities v and gravity g in the
// world,
//
//   R = R_start^T R_end
//   v = R_start^T (v_end - v_start - g t)
//   p = R_start^T (p_end - p_start - v_start t - g t^2 / 2).
//
// Small changes of it are [omega v p], R(omega) = R Exp(omega).
struct PreintegratedMotion {
  double seconds = 0.0;                                                // t
  Eigen::Quaterniond start_from_end = Eigen::Quaterniond::Identity();  // R
  Eigen::Vector3d v = Eigen::Vector3d::Zero();                         // m/s
  Eigen::Vector3d p = Eigen::Vector3d::Zero();                         // m

  // The bias that was taken off the samples, and d[omega v p] / d(bias).
  ImuBiasVector bias = ImuBiasVector::Zero();
  Eigen::Matrix<double, 9, 6> by_bias = Eigen::Matrix<double, 9, 6>::Zero();

  // Covariance of [omega v p gyro accel]: of what the true motion is more than
  // this one, and of how much the biases change until the end.
  using Covariance = Eigen::Matrix<double, 15, 15>;
  Covariance covariance = Covariance::Zero();

  // S with S^T S = covariance^-1. Throws InputError if the covariance is not
  // finite and positive definite.
  Covariance SqrtInformation() const;
};

// Sums up samples, such as those of ImuBuffer::Between, from the first stamp
// to the last; rates and accelerations are linear in between. Biases are
// constant but for their random walk. Throws InputError for fewer than two
// samples, for stamps that do not increase, and for ImuNoise::Check.
PreintegratedMotion Preintegrate(const std::vector<ImuSample>& samples,
                                 const ImuBiasVector& bias,
                                 const ImuNoise& noise);

}  // namespace rgbd_pose
