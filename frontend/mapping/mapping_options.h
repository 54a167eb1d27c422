#pragma once

#include <string>

namespace rgbd_pose {

// Which keyframes are joined to which.
struct MappingOptions {
  // A new keyframe is paired with at most so many older ones that see the same:
  // half of them those that see most of it, half the oldest, which hold the
  // drift.
  int max_pairs = 8;

  // Two see the same if each shows such a share of the other.
  double min_pair_share = 0.4;

  // So many keyframes that look alike are asked whether they show the same
  // place; 0: loops are found by pose alone, and segments are not joined.
  int max_loop_candidates = 4;

  // A keyframe is removed if an older one sees such a share of it from near by:
  // a map grows with the place, not with time.
  double redundant_share = 0.85;

  // Poses of the latest keyframes, and of those that the newest is paired with,
  // are solved for at each keyframe; after a loop all are.
  int window = 10;

  // By what share of the way and of the turns a path drifts at most, as one
  // standard deviation: what a loop may correct.
  double drift = 0.01;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
