#pragma once

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

  // The number of links on the shortest path, or `most` if there are more.
  int Hops(int from, int to, int most) const;

  // A path with the fewest links, including both ends; empty if there is none.
  std::vector<int> ShortestPath(int from, int to) const;

  // For each keyframe the smallest number in its connected component.
  std::vector<int> FirstOfParts() const;

  // Whether the neighbours of a keyframe are near each other without it.
  bool StaysConnectedWithout(int at) const;

 private:
  // For each keyframe the number of links on the shortest path from `from` that
  // avoids `without`; -1 for more than `most` links.
  std::vector<int> Distances(int from, int most, int without = -1) const;

  std::vector<std::vector<int>> neighbors_;
};

}  // namespace rgbd_pose
