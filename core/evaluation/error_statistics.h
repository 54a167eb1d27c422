#pragma once

#include <vector>

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

}  // namespace rgbd_pose
