#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "core/factors/blocks.h"
#include "core/inertial/imu_buffer.h"

namespace rgbd_pose {

// The shaking of a hand as functions of time (s), with what an exact inertial
// sensor measures along it.
struct ImuPath {
  Eigen::Vector3d gravity = {0.3, -0.2, -9.8};  // m/s^2; not along an axis

  // world_from_sensor.
  PoseOf<double> Pose(double t) const {
    return {Turn(kFirst, First(t)) * Turn(kSecond, Second(t)), Position(t)};
  }

  // In the world, m/s.
  Eigen::Vector3d Velocity(double t) const {
    return {0.9 * std::cos(3.0 * t), -1.0 * std::sin(5.0 * t),
            0.7 + 0.8 * std::cos(4.0 * t)};
  }

  ImuSample Sample(double t) const {
    const Eigen::Vector3d acceleration(-2.7 * std::sin(3.0 * t),
                                       -5.0 * std::cos(5.0 * t),
                                       -3.2 * std::sin(4.0 * t));
    const Eigen::Vector3d gyro =
        3.6 * std::cos(3.0 * t) *
            (Turn(kSecond, Second(t)).conjugate() * kFirst) -
        3.5 * std::sin(7.0 * t) * kSecond;
    return {t, gyro, Pose(t).q.conjugate() * (acceleration - gravity)};
  }

  // Samples at a rate (1/s) from one time up to another.
  std::vector<ImuSample> Samples(double from, double to, double rate) const {
    std::vector<ImuSample> samples;
    const int steps = static_cast<int>(std::lround((to - from) * rate));
    for (int k = 0; k <= steps; ++k) samples.push_back(Sample(from + k / rate));
    return samples;
  }

 private:
  static inline const Eigen::Vector3d kFirst = {0.6, 0.0, 0.8};
  static inline const Eigen::Vector3d kSecond = {0.0, 1.0, 0.0};

  static Eigen::Quaterniond Turn(const Eigen::Vector3d& axis, double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  }
  static double First(double t) { return 1.2 * std::sin(3.0 * t); }
  static double Second(double t) { return 0.5 * std::cos(7.0 * t); }
  static Eigen::Vector3d Position(double t) {
    return {0.3 * std::sin(3.0 * t), 0.2 * std::cos(5.0 * t),
            0.7 * t + 0.2 * std::sin(4.0 * t)};
  }
};

// Errors of a sensor: white noise, and biases that start somewhere and walk.
class ImuErrors {
 public:
  ImuErrors(const ImuNoise& noise, const ImuBiasVector& bias, unsigned seed)
      : noise_(noise), bias_(bias), random_(seed) {}

  // Puts the errors on samples of a constant rate (1/s), whose biases walk on.
  std::vector<ImuSample> On(std::vector<ImuSample> samples, double rate) {
    for (size_t k = 0; k < samples.size(); ++k) {
      if (k > 0) {
        bias_.head<3>() += noise_.gyro_walk / std::sqrt(rate) * Normal();
        bias_.tail<3>() += noise_.accel_walk / std::sqrt(rate) * Normal();
      }
      samples[k].gyro +=
          bias_.head<3>() + noise_.gyro_density * std::sqrt(rate) * Normal();
      samples[k].accel +=
          bias_.tail<3>() + noise_.accel_density * std::sqrt(rate) * Normal();
    }
    return samples;
  }

  // At the last sample.
  const ImuBiasVector& bias() const { return bias_; }

 private:
  Eigen::Vector3d Normal() {
    return {normal_(random_), normal_(random_), normal_(random_)};
  }

  const ImuNoise noise_;
  ImuBiasVector bias_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace rgbd_pose
