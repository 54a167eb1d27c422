#pragma once

#include <cstddef>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

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

// An estimated pose and the ground truth of the same moment. Each counts from
// a world of its own; both map from the same camera.
struct PosePair {
  double timestamp = 0.0;  // of the estimate, s
  Rigid3d truth;           // truth_world_from_cam
  Rigid3d estimate;        // estimate_world_from_cam
};

// The time stamps of a list of what has one.
template <typename Stamped>
std::vector<double> TimesOf(const std::vector<Stamped>& list) {
  std::vector<double> times;
  times.reserve(list.size());
  for (const Stamped& entry : list) times.push_back(entry.timestamp);
  return times;
}

// The place of the time nearest to `time` in a sorted list that is not empty;
// the earlier one of two that are as near.
size_t NearestTime(const std::vector<double>& times, double time);

// Pairs poses nearest in time and at most `max_time_difference` (s) apart, each
// used at most once (association.h), in time order. Throws InputError, naming
// the time ranges, if there is no such pair.
std::vector<PosePair> PairPoses(const Trajectory& estimate,
                                const Trajectory& ground_truth,
                                double max_time_difference);

}  // namespace rgbd_pose
