#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// A trajectory, interpolated between its poses: positions linearly,
// orientations spherically, but not across gaps of `max_gap` (s) or more: a
// hand can make any motion within 50 ms.
class InterpolatedPath {
 public:
  // The trajectory must outlive this object.
  explicit InterpolatedPath(const Trajectory& trajectory, double max_gap = 0.05)
      : trajectory_(trajectory), max_gap_(max_gap) {}

  // Returns world_from_cam at this time (s); nothing in a gap, before the first
  // pose or after the last.
  std::optional<Rigid3d> At(double time) const;

  // The poses at all of these times plus `shift` (s).
  std::vector<std::optional<Rigid3d>> At(const std::vector<double>& times,
                                         double shift) const;

 private:
  const Trajectory& trajectory_;
  const double max_gap_;
};

// A pose and its velocity.
struct MovingPose {
  Rigid3d world_from_cam;
  Twist velocity;  // in the camera's own axes, rad/s and m/s
};

// The poses at these times (s) with velocities from the previous to the next
// pose; nothing where one of the three is missing or they are too far apart.
std::vector<std::optional<MovingPose>> MovingPoses(
    const std::vector<double>& times,
    const std::vector<std::optional<Rigid3d>>& poses);

// The motion from one pose to a later one, in the axes of the first, and its
// rate of change when both poses are shifted to a later time.
struct PoseChange {
  PoseChange(const MovingPose& from, const MovingPose& to);

  Eigen::Matrix3d rotation;     // from_from_to
  Eigen::Vector3d turn;         // the same as a rotation vector, rad
  Eigen::Vector3d translation;  // m
  Twist rate;                   // of turn (first order) and translation
};

}  // namespace rgbd_pose
