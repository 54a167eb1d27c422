#pragma once

#include <optional>
#include <utility>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// The motion between frames as something else tells it (wheel odometry, an
// inertial sensor, another tracker): a trajectory of the camera, in any world
// and at any rate.
class MotionGuess {
 public:
  // World from camera, whatever the world.
  explicit MotionGuess(Trajectory trajectory)
      : trajectory_(std::move(trajectory)) {}

  // cur_from_prev between two times (s); nothing where the trajectory has a gap
  // or has not begun or has ended.
  std::optional<Rigid3d> CurFromPrev(double prev_time, double cur_time) const;

 private:
  std::optional<Rigid3d> WorldFromCam(double time) const;

  Trajectory trajectory_;
};

}  // namespace rgbd_pose
