#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace rgbd_pose {

// The value below which `share` (0 to 1) of the values lie, interpolated
// between two values; NaN if there are none. Reorders the values.
inline double QuantileInPlace(std::vector<double>* values, double share) {
  if (values->empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(values->size() - 1);
  const auto below = values->begin() + static_cast<ptrdiff_t>(place);
  std::nth_element(values->begin(), below, values->end());
  if (below + 1 == values->end()) return *below;
  const double above = *std::min_element(below + 1, values->end());
  return *below + (place - std::floor(place)) * (above - *below);
}

inline double Quantile(std::vector<double> values, double share) {
  return QuantileInPlace(&values, share);
}

// Sigma of a normal distribution, divided by the median of absolute values.
inline constexpr double kSigmaOfMedian = 1.4826;

inline double Median(const std::vector<double>& values) {
  return Quantile(values, 0.5);
}

// The median without interpolation: the upper of the two middle values if their
// number is even. Requires at least one value. Reorders the values.
inline double UpperMedian(std::vector<double>* values) {
  const auto middle = values->begin() + values->size() / 2;
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace rgbd_pose
