#pragma once

#include <string>

namespace rgbd_pose {

// The options of Mapper.
struct MappingOptions {
  // Maximum number of older keyframes that a new one is paired with by its
  // pose. Half of them are those that see most of its view; the others are the
  // oldest ones, which limit the drift.
  int max_pairs = 8;

  // Two keyframes see the same if each shows this share of the other's view.
  double min_pair_share = 0.4;

  // Number of similar keyframes that are checked for showing the same place. 0:
  // loops are found only by pose, and segments are not joined.
  int max_loop_candidates = 4;

  // A keyframe is removed if an older one nearby sees this share of its view. A
  // map thus grows with the size of the place, not with time.
  double redundant_share = 0.85;

  // Number of latest keyframes whose poses are optimised at each keyframe,
  // together with those paired with the newest one. After a loop all are.
  int window = 10;

  // Maximum drift of a path relative to its length and rotation, as one
  // standard deviation. It limits the correction by a loop.
  double drift = 0.01;

  // A one-line description of an error in the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
