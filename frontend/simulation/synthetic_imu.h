#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// A simulated inertial sensor and its faults. The defaults are those of a
// consumer sensor; with `noise` false it is exact but for its other fields.
struct SyntheticImuOptions {
  double rate_hz = 200.0;     // samples per second
  bool noise = true;          // white noise and walk of `densities`
  ImuNoise densities = {};    // of the noise
  Rigid3d cam_from_imu = {};  // the mounting
  uint32_t seed = 1;          // of the noise

  // At the first sample: [gyro accel], rad/s and m/s^2.
  ImuBiasVector bias = ImuBiasVector::Zero();

  // How much later than the camera's clock its clock says, s: the sample with
  // stamp t is from t - delay_s.
  double delay_s = 0.0;

  // What the axes of a perfect sensor are turned into: scale factors on the
  // diagonal, misalignment beside it.
  Eigen::Matrix3d gyro_axes = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d accel_axes = Eigen::Matrix3d::Identity();

  // Larger values of an axis are cut off, rad/s and m/s^2.
  double gyro_limit = std::numeric_limits<double>::infinity();
  double accel_limit = std::numeric_limits<double>::infinity();

  // Why these options cannot be used; empty if they can.
  std::string Check() const;
};

// Samples of the sensor with stamps from `from` to `to` (s) along a path
// world_from_cam, whose z axis is up: gravity is 9.81 m/s^2. Velocities and
// accelerations are differences of the exact path over 1 ms, of fourth order:
// right to 1e-7 rad/s and m/s^2 where it is smooth. The path is asked for times
// up to 2 ms beyond those of the samples. The same options give the same
// samples. Throws InputError for invalid options.
std::vector<ImuSample> SimulateImu(
    const std::function<Rigid3d(double t)>& world_from_cam, double from,
    double to, const SyntheticImuOptions& options);

}  // namespace rgbd_pose
