#pragma once

#include <optional>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A trajectory between its poses, too: places along the line, orientations
// along the arc, but not across gaps of 50 ms or more, where a hand may do
// anything.
class InterpolatedPath {
 public:
  // Of a trajectory that outlives it.
  explicit InterpolatedPath(const Trajectory& trajectory)
      : trajectory_(trajectory) {}

  // world_from_cam at this time (s); nothing in a gap, before the first pose or
  // after the last.
  std::optional<Rigid3d> At(double time) const;

  // At all of these times plus `shift` (s).
  std::vector<std::optional<Rigid3d>> At(const std::vector<double>& times,
                                         double shift) const;

 private:
  const Trajectory& trajectory_;
};

}  // namespace rgbd_pose
