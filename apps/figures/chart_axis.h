#pragma once

#include <vector>

namespace rgbd_pose {

struct AxisRange {
  double low = 0.0;
  double high = 1.0;

  double span() const { return high - low; }
  double Share(double value) const { return (value - low) / span(); }
};

// The range of some values with a margin. Non-finite values are ignored.
AxisRange RangeOf(const std::vector<double>& values);

// A tick. On a logarithmic axis, `place` is the decimal logarithm of `value`.
struct AxisTick {
  double place = 0.0;
  double value = 0.0;
};

// Ticks at multiples of 1, 2 or 5 times a power of ten, about four to eight.
std::vector<AxisTick> LinearTicks(const AxisRange& range);

// Ticks at powers of ten, also at 2 and 5 times them if there are few.
std::vector<AxisTick> LogTicks(const AxisRange& range);

}  // namespace rgbd_pose
