#pragma once

#include <optional>
#include <utility>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// Motion between frames from another source (wheel odometry, an inertial
// sensor, another tracker), given as a trajectory of the camera in any world
// frame and at any rate.
class MotionGuess {
 public:
  // `trajectory`: world from camera, in any world frame.
  explicit MotionGuess(Trajectory trajectory)
      : trajectory_(std::move(trajectory)) {}

  // Returns cur_from_prev between two times (s), or nothing in gaps of the
  // trajectory, before its start and after its end.
  std::optional<Rigid3d> CurFromPrev(double prev_time, double cur_time) const;

 private:
  std::optional<Rigid3d> WorldFromCam(double time) const;

  Trajectory trajectory_;
};

}  // namespace rgbd_pose
