#pragma once

#include <vector>

namespace rgbd_pose {

// Two entries, one of each of two stamped lists, that belong together.
struct IndexPair {
  int first = 0;   // index in the first list
  int second = 0;  // index in the second list
};

// Pairs two lists of strictly increasing, finite time stamps (s) by nearest
// time, at most `max_difference` (s) apart: the pair with the smallest
// difference first, then the smallest of what is left, each entry used once
// (as associate.py of the TUM RGB-D benchmark does). Of equal differences the
// earlier pair wins. The result is in the order of the first list. Takes
// O(n log n) for n entries in both lists, however close they are.
std::vector<IndexPair> Associate(const std::vector<double>& first,
                                 const std::vector<double>& second,
                                 double max_difference);

}  // namespace rgbd_pose
