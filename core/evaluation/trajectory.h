#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A camera pose and its time.
struct StampedPose {
  double timestamp = 0.0;  // s
  Rigid3d world_from_cam;  // m
};

// Poses with strictly increasing timestamps.
using Trajectory = std::vector<StampedPose>;

// The pose (world_from_cam) at a time (s), interpolated between two poses: the
// position linearly, the orientation spherically. Nothing outside the poses or
// in a gap of `max_gap` (s) or more: a hand can make any motion within 50 ms.
std::optional<Rigid3d> InterpolatedPose(const Trajectory& trajectory,
                                        double time, double max_gap = 0.05);

// The motion cur_from_prev between two times (s) along a trajectory of another
// source (wheels, an inertial sensor). Nothing in its gaps and beyond its ends.
std::optional<Rigid3d> MotionAlong(const Trajectory& trajectory,
                                   double prev_time, double cur_time);

// Reads TUM text with one `timestamp tx ty tz qx qy qz qw` per line (world from
// camera, metres; see ReadTextTable). Quaternions within 1 % of unit length are
// normalised. If poses have the same timestamp, the first is kept, and a line
// for users is added to `remarks` unless that is null. Throws InputError
// (file:line) for anything else, also for an empty list.
Trajectory ReadTrajectory(const std::string& path,
                          std::vector<std::string>* remarks = nullptr);

// Formats a trajectory as TUM text: timestamps with 6 decimals, poses with 9.
std::string FormatTrajectory(const Trajectory& trajectory);

}  // namespace rgbd_pose
