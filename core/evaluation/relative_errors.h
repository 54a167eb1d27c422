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
  double median = 0.0;  // of an even number, the mean of the two in the middle
  double max = 0.0;
  double p90 = 0.0;  // what 90 % of them stay below
  double p99 = 0.0;  // and 99 %
};

// In the unit of the errors.
ErrorStatistics Summarise(std::vector<double> errors);

// Errors of motions between two poses i and j of the camera (Sturm 2012):
// E = (truth_i^-1 truth_j)^-1 (estimate_i^-1 estimate_j).
struct RelativePoseError {
  ErrorStatistics translation;  // |translation of E|, m
  ErrorStatistics rotation;     // angle of E, rad
};

// From the place of one pose in a list to that of a later one.
using PoseInterval = std::pair<size_t, size_t>;

// E of RelativePoseError.
Rigid3d RelativeError(const PosePair& i, const PosePair& j);

// Those from every pose to the one so many, at least 1, after it.
std::vector<PoseInterval> FrameIntervals(size_t poses, size_t frames);

// Those from every pose to the one nearest to `delta` (s) after it, if that is
// off by at most `max_difference` (s). `times` (s) are sorted.
std::vector<PoseInterval> TimeIntervals(const std::vector<double>& times,
                                        double delta, double max_difference);

// Those from every pose to the first that is `delta` (m) or more further on.
// `path`: of every pose, the length (m) of the path that leads to it.
std::vector<PoseInterval> PathIntervals(const std::vector<double>& path,
                                        double delta);

// Errors over these intervals.
RelativePoseError SummariseIntervals(
    const std::vector<PosePair>& pairs,
    const std::vector<PoseInterval>& intervals);

}  // namespace rgbd_pose
