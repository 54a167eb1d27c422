#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// The samples of an inertial sensor, as a file has them.
struct ImuRecording {
  std::vector<ImuSample> samples;  // their stamps increase
  bool has_gyro = false;           // if not, all gyro are 0
  std::string warning;             // of ExamineImu, or on left-out samples

  // The mounting where the layout of the file says which device it was.
  std::optional<Rigid3d> cam_from_imu = {};
};

// Reads rows of numbers, separated by commas or white space, # before comments:
//
//   stamp gyro_x gyro_y gyro_z accel_x accel_y accel_z    EuRoC's imu0/data.csv
//   stamp accel_x accel_y accel_z                     TUM's accelerometer.txt
//
// The stamp is in s, or in nanoseconds (above 1e15); rad/s and m/s^2. Behind
// the header "timestamp, a_x, ..., alpha_z" acceleration comes first, as in the
// imu.csv of Stray Scanner, see stray_imu.h. Samples are sorted by their
// stamps; of those with the same stamp the first one is used, which the warning
// says. Throws InputError with file and line for what is no such row and for
// stamps that are more than 0.1 s too early, with the file for units that
// ExamineImu finds wrong.
ImuRecording ReadImuFile(const std::string& path);

// The text of a file that ReadImuFile reads as these samples, with stamps in s:
// EuRoC's columns, or without the angular velocity. A header is a comment.
std::string FormatImuRows(const std::vector<ImuSample>& samples, bool has_gyro,
                          bool has_header);

}  // namespace rgbd_pose
