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

// Quantiles of the chi-squared distribution with 1 to 6 degrees of freedom: of
// the squared norm of the whitened residual of an inlier.
constexpr double ChiSquaredMedian(int degrees) {
  constexpr double kMedian[] = {0.454936, 1.386294, 2.365974,
                                3.356694, 4.351460, 5.348121};
  return kMedian[std::clamp(degrees, 1, 6) - 1];
}
constexpr double ChiSquared99(int degrees) {
  constexpr double k99[] = {6.634897,  9.210340,  11.344867,
                            13.276704, 15.086272, 16.811894};
  return k99[std::clamp(degrees, 1, 6) - 1];
}

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
