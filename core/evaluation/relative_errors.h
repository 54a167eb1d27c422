#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/evaluation/association.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Statistics of a list of errors; all 0 if it is empty.
struct ErrorStatistics {
  int count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;  // mean of the two middle values if count is even
  double max = 0.0;
  double p90 = 0.0;  // 90 % of the errors are below it
  double p99 = 0.0;  // 99 % of the errors are below it
};

// The statistics have the unit of the errors.
ErrorStatistics Summarise(std::vector<double> errors);

// Errors of motions between two poses i and j of the camera (Sturm 2012):
// E = (truth_i^-1 truth_j)^-1 (estimate_i^-1 estimate_j).
struct RelativePoseError {
  ErrorStatistics translation;  // |translation of E|, m
  ErrorStatistics rotation;     // angle of E, rad
};

// Indices of a pose in a list and of a later one.
using PoseInterval = std::pair<size_t, size_t>;

// E of RelativePoseError.
Rigid3d RelativeError(const PosePair& i, const PosePair& j);

// Intervals from every pose to the one `frames` (at least 1) after it.
std::vector<PoseInterval> FrameIntervals(size_t poses, size_t frames);

// Intervals from every pose to the one nearest to `delta` (s) later, if its
// time is off by at most `max_difference` (s). `times` (s) must be sorted.
std::vector<PoseInterval> TimeIntervals(const std::vector<double>& times,
                                        double delta, double max_difference);

// Intervals from every pose to the first that is `delta` (m) or more further
// along. `path` is the length (m) of the path to each pose.
std::vector<PoseInterval> PathIntervals(const std::vector<double>& path,
                                        double delta);

// The relative pose error over the intervals.
RelativePoseError SummariseIntervals(
    const std::vector<PosePair>& pairs,
    const std::vector<PoseInterval>& intervals);

}  // namespace rgbd_pose
