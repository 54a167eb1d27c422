#pragma once

#include <string>
#include <vector>

#include "apps/export/export_format.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/motion.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// The poses of the first segment of a run. Throws InputError, which names what
// asks for it, if their times are not from 1970 to 2038, as ROS has them.
Trajectory TimedPath(const FinishedRun& run, const std::string& asked_by);

// A line for users on the poses that such a path leaves out; empty if none.
std::string LeftOut(const FinishedRun& run, const Trajectory& path);

// With x forward, y left and z up at the first camera pose, as ROS and viewers
// expect it.
Rigid3d UprightFromWorld();

// What a run tells of the camera at the time of a pose. Covariances are zero
// where they are not known.
struct CameraState {
  StampedPose pose;

  // Of [omega C] of the pose, as in keyframes.csv: relative to the first pose,
  // or to the first keyframe of a map that was loaded.
  MotionMatrix covariance = MotionMatrix::Zero();

  // The mean velocity from the pose before to the one after, in the camera's
  // axes, and the covariance of [angular linear] that follows from both poses.
  Twist twist;
  MotionMatrix twist_covariance = MotionMatrix::Zero();
};

// For the poses of TimedPath. The covariance of a keyframe of the map is that
// of the map; other covariances are composed along the motions of edges.csv.
std::vector<CameraState> StatesOf(const FinishedRun& run,
                                  const Trajectory& path);

}  // namespace rgbd_pose
