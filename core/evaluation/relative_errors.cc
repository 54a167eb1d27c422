#include "core/evaluation/relative_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/util/quantile.h"

namespace rgbd_pose {

ErrorStatistics Summarise(std::vector<double> errors) {
  ErrorStatistics result;
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  const double sum = std::accumulate(errors.begin(), errors.end(), 0.0);
  const double sum_of_squares =
      std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0);
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

Rigid3d RelativeError(const PosePair& i, const PosePair& j) {
  const Rigid3d truth_i_from_j = i.truth.Inverse() * j.truth;
  const Rigid3d estimate_i_from_j = i.estimate.Inverse() * j.estimate;
  return truth_i_from_j.Inverse() * estimate_i_from_j;
}

std::vector<PoseInterval> FrameIntervals(size_t poses, size_t frames) {
  std::vector<PoseInterval> intervals;
  for (size_t j = frames; j < poses; ++j) intervals.emplace_back(j - frames, j);
  return intervals;
}

std::vector<PoseInterval> TimeIntervals(const std::vector<double>& times,
                                        double delta, double max_difference) {
  std::vector<PoseInterval> intervals;
  for (size_t i = 0; i < times.size(); ++i) {
    const double end = times[i] + delta;
    const size_t j = NearestTime(times, end);
    if (std::abs(times[j] - end) <= max_difference) {
      intervals.emplace_back(i, j);
    }
  }
  return intervals;
}

std::vector<PoseInterval> PathIntervals(const std::vector<double>& path,
                                        double delta) {
  // Ten steps of 0.1 m count as 1 m despite rounding.
  constexpr double kRounding = 1e-9;
  std::vector<PoseInterval> intervals;
  size_t j = 0;
  for (size_t i = 0; i < path.size(); ++i) {
    while (j < path.size() && path[j] - path[i] < delta - kRounding) ++j;
    if (j == path.size()) break;
    intervals.emplace_back(i, j);
  }
  return intervals;
}

RelativePoseError SummariseIntervals(
    const std::vector<PosePair>& pairs,
    const std::vector<PoseInterval>& intervals) {
  std::vector<double> translations, angles;
  for (const auto& [i, j] : intervals) {
    const Rigid3d error = RelativeError(pairs[i], pairs[j]);
    translations.push_back(error.translation.norm());
    angles.push_back(error.Angle());
  }
  return {Summarise(std::move(translations)), Summarise(std::move(angles))};
}

}  // namespace rgbd_pose
