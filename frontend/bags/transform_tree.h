#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Frames of reference and how they lie in each other, as ROS publishes them
// (/tf): each frame has one parent. What does not move is kept once, however
// often it is said.
class TransformTree {
 public:
  // A frame in its parent at a time (s). In any order.
  void Add(const std::string& parent, const std::string& child, double stamp,
           const Rigid3d& parent_from_child);

  // target_from_source, if they are known not to move against each other.
  std::optional<Rigid3d> Fixed(const std::string& target,
                               const std::string& source) const;

  // How a frame moved in one above it (world_from_frame): a pose each time that
  // what moves most often was received; empty if nothing between them moves.
  Trajectory PathOf(const std::string& world, const std::string& frame) const;

 private:
  struct Edge {
    std::string parent;
    bool moves = false;
    // In order of time; of one that does not move, the first and the last.
    Trajectory samples;  // parent_from_child
  };

  // The edges from a frame up to another, that of the frame first; nothing if
  // that is not above it.
  std::optional<std::vector<const Edge*>> Up(const std::string& frame,
                                             const std::string& top) const;

  // The frame and all those above it.
  std::vector<std::string> Above(const std::string& frame) const;

  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace rgbd_pose
