#pragma once

#include "core/evaluation/trajectory.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// From a smooth path of the camera (world from camera, any world), at the time
// of one of its frames (s): central differences of the fourth order, where
// frames follow each other evenly. Zero where nothing is known.
Twist TwistAt(const Trajectory& path, double time);

}  // namespace rgbd_pose
