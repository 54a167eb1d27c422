#pragma once

#include <Eigen/Core>
#include <string>

namespace rgbd_pose {

// What an inertial sensor measures at one moment, in its own axes. An
// accelerometer measures the acceleration less gravity: at rest 9.81 m/s^2
// upwards.
struct ImuSample {
  double stamp = 0.0;                               // s
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   // rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  // m/s^2
};

// What an inertial sensor adds to its measurements: [gyro accel], rad/s, m/s^2.
using ImuBiasVector = Eigen::Matrix<double, 6, 1>;

// The noise of an inertial sensor in continuous time, as in Kalibr's imu.yaml
// and in data sheets. A sample taken every dt seconds has the standard
// deviation density / sqrt(dt); in dt a bias moves by walk * sqrt(dt). The
// defaults are the order of a consumer sensor (BMI055: 2.4e-4 and 1.5e-3); what
// shakes the sensor faster than it measures has to be added to its densities.
struct ImuNoise {
  double gyro_density = 3e-4;   // rad/s/sqrt(Hz)
  double accel_density = 2e-3;  // m/s^2/sqrt(Hz)
  double gyro_walk = 2e-5;      // rad/s^2/sqrt(Hz)
  double accel_walk = 3e-4;     // m/s^3/sqrt(Hz)

  // Why these values cannot be used; empty if they can.
  std::string Check() const;
};

}  // namespace rgbd_pose
