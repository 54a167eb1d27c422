#pragma once

#include <Eigen/Core>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// Of points in the axes of a camera that moves.
struct CameraVelocity {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     // rad/s
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m/s
};

// From a smooth path of the camera (world from camera, any world), at the time
// of one of its frames (s): central differences of the fourth order, where
// frames follow each other evenly. Zero where nothing is known.
CameraVelocity VelocityAt(const Trajectory& path, double time);

}  // namespace rgbd_pose
