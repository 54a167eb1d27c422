#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"
#include "frontend/bags/ros_messages.h"

namespace rgbd_pose {

// The tree of coordinate frames published by ROS (/tf): each frame has one
// parent. Repetitions of a transform that does not change are not stored.
class TransformTree {
 public:
  // Adds poses of frames in their parents, in any order of time.
  void Add(const std::vector<RosTransform>& transforms);

  // target_from_source, if it is known and does not change.
  std::optional<Rigid3d> Fixed(const std::string& target,
                               const std::string& source) const;

  // The trajectory world_from_frame of a frame in a frame above it, with a pose
  // for each sample of the edge that has most samples. Empty if no edge moves.
  Trajectory PathOf(const std::string& world, const std::string& frame) const;

 private:
  struct Edge {
    std::string parent;
    bool moves = false;
    // parent_from_child by time; only the first and the last if it never moves.
    Trajectory samples;
  };

  // The frame and those above it in which it does not move, with the motion
  // from the frame to them.
  std::vector<std::pair<std::string, Rigid3d>> FixedAbove(
      const std::string& frame) const;

  std::map<std::string, Edge> edges_;  // by child frame
};

}  // namespace rgbd_pose
