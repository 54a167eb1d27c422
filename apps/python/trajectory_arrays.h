#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// A trajectory from the path of a TUM text file or a pair of time stamps (N,)
// and poses (N, 7) tx ty tz qx qy qz qw or (N, 4, 4). Throws InputError, naming
// the argument, for anything else.
Trajectory TrajectoryFrom(const pybind11::object& object,
                          const std::string& name);

// A pair of time stamps (N,) and poses (N, 4, 4).
pybind11::tuple ArraysFromTrajectory(const Trajectory& trajectory);

}  // namespace rgbd_pose
