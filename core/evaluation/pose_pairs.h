#pragma once

#include <cstddef>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// An estimated pose and the ground truth of the same moment. Each counts from
// a world of its own; both map from the same camera.
struct PosePair {
  double timestamp = 0.0;  // of the estimate, s
  Rigid3d truth;           // truth_world_from_cam
  Rigid3d estimate;        // estimate_world_from_cam
};

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
