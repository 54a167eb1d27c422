#pragma once

#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// One pose of a trajectory. The time stamp is in seconds.
struct StampedPose {
  double timestamp = 0.0;  // s
  Rigid3d world_from_cam;  // m
};

// Poses with strictly increasing time stamps.
using Trajectory = std::vector<StampedPose>;

// Reads TUM text, `timestamp tx ty tz qx qy qz qw` a line (world from camera,
// metres), '#' comments and empty lines skipped, CRLF and a byte order mark
// taken. Quaternions within 1 % of unit length are normalised. Of poses of the
// same time stamp the first is taken, and a line for users is added to
// `remarks` unless that is null. Throws InputError (file:line) for anything
// else: missing columns, words that are no numbers, NaN, time stamps out of
// order, an empty list.
Trajectory ReadTrajectory(const std::string& path,
                          std::vector<std::string>* remarks = nullptr);

// The same as TUM text: 6 decimals in time stamps, 9 in poses.
std::string FormatTrajectory(const Trajectory& trajectory);

}  // namespace rgbd_pose
