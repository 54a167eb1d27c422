#pragma once

#include <string>
#include <vector>

#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// What the samples themselves say of their units and axes.
struct ImuFindings {
  std::string error;    // a wrong unit, in a line; empty if there is none
  std::string warning;  // axes or a scale that do not fit, likewise
};

// Tests whether accelerations are in m/s^2 and angular velocities in rad/s, by
// the size of gravity and by how its direction moves in the axes of a sensor
// that turns; whether the axes of gyroscope and accelerometer are the same.
// Says nothing of what the motion does not show. A recording without a
// gyroscope has zeros for it. Samples that are not finite do not count.
ImuFindings ExamineImu(const std::vector<ImuSample>& recorded);

}  // namespace rgbd_pose
