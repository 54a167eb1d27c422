#pragma once

#include <limits>
#include <vector>

namespace rgbd_pose {

// Which keyframes are linked by pairs, regardless of the measured motions.
// Keyframes have numbers 0, 1, 2, ...
class CovisibilityGraph {
 public:
  // Adds a keyframe without links.
  void Add() { neighbors_.emplace_back(); }
  void Join(int a, int b);
  // Removes all links of a keyframe.
  void Separate(int at);

  // The keyframes that a keyframe is linked to.
  const std::vector<int>& Neighbors(int at) const { return neighbors_[at]; }
  bool AreJoined(int a, int b) const;

  // For each keyframe whether it is within `hops` links of `from`.
  std::vector<bool> Within(int from, int hops) const;

  // A path with the fewest links, including both ends; empty if there is none.
  std::vector<int> ShortestPath(int from, int to) const;

  // For each keyframe the smallest number in its connected component.
  std::vector<int> FirstOfParts() const;

  // Whether the neighbours of a keyframe are near each other without it.
  bool StaysConnectedWithout(int at) const;

 private:
  // Searches breadth first, up to `hops` links away, but not through keyframes
  // with an entry in `before` (-1: none). Returns the keyframes reached and
  // enters for each the one it was reached from.
  std::vector<int> Reach(int from, std::vector<int>* before,
                         int hops = std::numeric_limits<int>::max()) const;

  std::vector<std::vector<int>> neighbors_;
};

}  // namespace rgbd_pose
