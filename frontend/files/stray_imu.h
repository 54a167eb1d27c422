#pragma once

#include "frontend/files/imu_file.h"

namespace rgbd_pose {

// The columns of the imu.csv of the app Stray Scanner for iPhones.
inline constexpr char kStrayImuColumns[] =
    "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z";

// Converts what the app writes: Core Motion's accelerations, which point down
// at rest, by versions up to 2024 in m/s^2, since then in g. Which of both, the
// size of gravity tells. Sets the mounting, whose translation is not known: 0.
void ConvertStrayImu(ImuRecording* recording);

}  // namespace rgbd_pose
