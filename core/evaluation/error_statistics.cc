#include "core/evaluation/error_statistics.h"

#include <algorithm>
#include <cmath>

#include "core/util/quantile.h"

namespace rgbd_pose {

ErrorStatistics Summarise(std::vector<double> errors) {
  ErrorStatistics result;
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  const size_t n = errors.size();
  result.count = static_cast<int>(n);
  result.rmse = std::sqrt(sum_of_squares / n);
  result.mean = sum / n;
  result.median = (errors[(n - 1) / 2] + errors[n / 2]) / 2.0;
  result.max = errors.back();
  result.p90 = QuantileInPlace(&errors, 0.9);
  result.p99 = QuantileInPlace(&errors, 0.99);
  return result;
}

}  // namespace rgbd_pose
