#pragma once

#include <optional>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// Returns the motion between two times (s), cur_from_prev, from another source
// (wheel odometry, an inertial sensor, another tracker), given as a trajectory
// of the camera in any world frame and at any rate. Nothing in gaps of the
// trajectory, before its start and after its end.
std::optional<Rigid3d> MotionAlong(const Trajectory& trajectory,
                                   double prev_time, double cur_time);

}  // namespace rgbd_pose
