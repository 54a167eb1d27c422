#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/export/camera_states.h"
#include "apps/export/export_format.h"
#include "apps/shell/csv_table.h"
#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// The poses of the first segment of a run. Throws InputError if their times are
// not from 1970 to 2038, as ROS has them.
Trajectory TimedPath(const FinishedRun& run);

// The keyframes of a run's map; nothing without a map.
std::optional<CsvTable> KeyframesOf(const FinishedRun& run);

// Whether ROS has a time (s), from 1970 to 2038.
bool IsRosTime(double seconds);

// The time (s) as trajectories have it, with 6 decimals.
double RosTime(double seconds);

// A line for users on the number of poses that are left out, because they are
// not of the first segment; empty if none.
std::string LeftOut(size_t poses);

// Turns the axes of a level camera (x right, y down, z ahead) into those that
// ROS and viewers expect: x forward, y left, z up.
Rigid3d UprightFromLevel();

// For the poses of TimedPath. The covariance of a keyframe of the map is that
// of the map; other covariances are composed along the motions of edges.csv.
std::vector<CameraState> StatesOf(const FinishedRun& run,
                                  const Trajectory& path);

}  // namespace rgbd_pose
