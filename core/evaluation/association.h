#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The indices of a pair of entries in the first and in the second of two lists.
using IndexPair = std::pair<int, int>;

// Pairs two lists of strictly increasing, finite timestamps (s) by nearest
// time, at most `max_difference` (s) apart, each entry once: the nearest pair
// first, the earlier of two equal ones (as in associate.py of the TUM RGB-D
// benchmark). The result is in the order of the first list. O(n log n).
std::vector<IndexPair> Associate(const std::vector<double>& first,
                                 const std::vector<double>& second,
                                 double max_difference);

// An estimated and a true pose at the same time, each in its own world.
struct PosePair {
  double timestamp = 0.0;  // of the estimate, s
  Rigid3d truth;           // truth_world_from_cam
  Rigid3d estimate;        // estimate_world_from_cam
};

// The timestamps of the entries of a list.
template <typename List>
std::vector<double> TimesOf(const List& list) {
  std::vector<double> times;
  times.reserve(list.size());
  for (const auto& entry : list) times.push_back(entry.timestamp);
  return times;
}

// The index of the (earlier) nearest time in a sorted, non-empty list.
size_t NearestTime(const std::vector<double>& times, double time);

// Pairs poses that are nearest in time and at most `max_time_difference` (s)
// apart, each used at most once (see Associate), in time order. Throws
// InputError with the time ranges if there is no such pair.
std::vector<PosePair> PairPoses(const Trajectory& estimate,
                                const Trajectory& ground_truth,
                                double max_time_difference);

}  // namespace rgbd_pose
