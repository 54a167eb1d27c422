#pragma once

#include <string>
#include <vector>

#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// The samples of an inertial sensor, as a file has them.
struct ImuRecording {
  std::vector<ImuSample> samples;  // their stamps increase
  bool has_gyro = false;           // if not, all gyro are 0
  std::string warning;             // of ExamineImu
};

// Reads rows of numbers, separated by commas or white space, # before comments:
//
//   stamp gyro_x gyro_y gyro_z accel_x accel_y accel_z    EuRoC's imu0/data.csv
//   stamp accel_x accel_y accel_z                     TUM's accelerometer.txt
//
// The stamp is in s, or in nanoseconds (above 1e15); rad/s and m/s^2. Throws
// InputError with file and line for what is no such row and for stamps that do
// not increase, with the file for units that ExamineImu finds wrong.
ImuRecording ReadImuFile(const std::string& path);

}  // namespace rgbd_pose
