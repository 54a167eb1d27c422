#pragma once

#include <vector>

namespace rgbd_pose {

// Which keyframes are joined to which by a pair, whatever it says. Keyframes
// have numbers 0, 1, 2, ...
class CovisibilityGraph {
 public:
  // Makes room for one more, joined to none.
  void Add() { neighbors_.emplace_back(); }
  void Join(int a, int b);
  // Takes all links of one away.
  void Separate(int at);

  // Those that one is joined to.
  const std::vector<int>& Neighbors(int at) const { return neighbors_[at]; }
  bool AreJoined(int a, int b) const;

  // Whether each keyframe is within so many links of one.
  std::vector<bool> Within(int from, int hops) const;

  // The number of links on the shortest way between two, at most `most`.
  int Hops(int from, int to, int most) const;

  // A way with the fewest links, both ends among them, from `from` on; empty if
  // there is none.
  std::vector<int> ShortestPath(int from, int to) const;

  // Of each keyframe the smallest number among all that hang together with it.
  std::vector<int> FirstOfParts() const;

  // Whether the neighbours of one would still be near to each other without it.
  bool StaysConnectedWithout(int at) const;

 private:
  // Of each keyframe the number of links on the shortest way from one that does
  // not lead through `without`; -1: there are more than `most`.
  std::vector<int> Distances(int from, int most, int without = -1) const;

  std::vector<std::vector<int>> neighbors_;
};

}  // namespace rgbd_pose
