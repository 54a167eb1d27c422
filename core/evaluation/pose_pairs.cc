#include "core/evaluation/pose_pairs.h"

#include <algorithm>
#include <string>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

std::vector<double> Times(const Trajectory& trajectory) {
  std::vector<double> times;
  times.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) times.push_back(pose.timestamp);
  return times;
}

std::string TimeRange(const std::vector<double>& times) {
  if (times.empty()) return "no poses";
  return Format("%.6f s to %.6f s", times.front(), times.back());
}

}  // namespace

size_t NearestTime(const std::vector<double>& times, double time) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return 0;
  const auto before = after - 1;
  const bool before_is_nearest =
      after == times.end() || time - *before <= *after - time;
  return (before_is_nearest ? before : after) - times.begin();
}

std::vector<PosePair> PairPoses(const Trajectory& estimate,
                                const Trajectory& ground_truth,
                                double max_time_difference) {
  const std::vector<double> estimate_times = Times(estimate);
  const std::vector<double> truth_times = Times(ground_truth);
  std::vector<PosePair> pairs;
  for (const auto [i, j] :
       Associate(estimate_times, truth_times, max_time_difference)) {
    pairs.push_back({estimate_times[i], ground_truth[j].world_from_cam,
                     estimate[i].world_from_cam});
  }
  if (pairs.empty()) {
    throw InputError("no pose of the estimate (" + TimeRange(estimate_times) +
                     ") is within " + Format("%g", max_time_difference) +
                     " s of one of the ground truth (" +
                     TimeRange(truth_times) +
                     "); check that both belong to the same sequence");
  }
  return pairs;
}

}  // namespace rgbd_pose
