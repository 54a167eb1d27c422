#pragma once

#include <string>
#include <vector>

#include "core/inertial/imu_calibration.h"
#include "frontend/files/yaml_section.h"

namespace rgbd_pose {

// The keys of an inertial sensor, as Kalibr names them:
//
//   T_cam_imu               cam_from_imu, a 4 x 4 matrix, m (its inverse is
//                           read as well: T_imu_cam of OpenVINS, and
//                           IMU.T_b_c1 or Tbc of ORB-SLAM3)
//   timeshift_cam_imu       delay_s
//   gyroscope_noise_density, gyroscope_random_walk,
//   accelerometer_noise_density, accelerometer_random_walk     ImuNoise, all
//   four or none; in ORB-SLAM3's files IMU.NoiseGyro, IMU.GyroWalk,
//   IMU.NoiseAcc, IMU.AccWalk
std::vector<std::string> ImuKeys();

// Reads these keys from the top level of a file, from its section imu0 and, the
// first two, from cam0. Throws InputError (file:line, key) for values that
// cannot be used.
ImuCalibration ReadImuCalibration(const YamlSection& file);

// The same from a file: Kalibr's imu.yaml, imu-NAME.yaml or camchain-imucam,
// EuRoC's sensor.yaml, or a camera file. Throws InputError if it has none of
// these keys, and for a key that was probably meant to be one of them.
ImuCalibration ReadImuCalibrationFile(const std::string& path);

// The text of a file that is read as this calibration.
std::string FormatImuCalibration(const ImuCalibration& calibration);

}  // namespace rgbd_pose
