#include "apps/figures/chart_axis.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {

AxisRange RangeOf(const std::vector<double>& values) {
  double low = INFINITY, high = -INFINITY;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (low > high) return {};
  if (low == high) return {low - 0.5, high + 0.5};
  const double room = 0.04 * (high - low);
  return {low - room, high + room};
}

std::vector<AxisTick> LinearTicks(const AxisRange& range) {
  const double power = std::pow(10.0, std::floor(std::log10(range.span())));
  const double step = range.span() < 1.5 * power   ? 0.2 * power
                      : range.span() < 3.5 * power ? 0.5 * power
                      : range.span() < 7.0 * power ? power
                                                   : 2.0 * power;
  std::vector<AxisTick> ticks;
  for (double i = std::ceil(range.low / step); i * step <= range.high; ++i) {
    ticks.push_back({i * step, i * step + 0.0});  // no -0
  }
  return ticks;
}

std::vector<AxisTick> LogTicks(const AxisRange& range) {
  constexpr double kFewPowers = 2.5;
  std::vector<AxisTick> ticks;
  for (double power = std::floor(range.low); power <= range.high; ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double place = power + std::log10(digit);
      if (place < range.low || place > range.high) continue;
      if (digit > 1.0 && range.span() >= kFewPowers) continue;
      ticks.push_back({place, digit * std::pow(10.0, power)});
    }
  }
  return ticks;
}

}  // namespace rgbd_pose
