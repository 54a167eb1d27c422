#pragma once

#include <cmath>
#include <vector>

namespace rgbd_pose {

// The values from one end of an axis to the other.
struct AxisRange {
  double low = 0.0;
  double high = 1.0;

  double span() const { return high - low; }
  double Share(double value) const { return (value - low) / span(); }
};

// The range of some values with some room around them. Values that are not
// finite do not count.
class AxisRangeFinder {
 public:
  void Add(double value);
  AxisRange Found() const;

 private:
  double low_ = INFINITY;
  double high_ = -INFINITY;
};

// A mark of an axis. Logarithmic axes are ranges of decimal logarithms: there
// the place is the logarithm of the value.
struct AxisTic {
  double place = 0.0;
  double value = 0.0;
};

// Steps of 1, 2 or 5 times a power of ten, some four to eight an axis.
std::vector<AxisTic> LinearTics(const AxisRange& range);

// Powers of ten, with 2 and 5 times them where there are few.
std::vector<AxisTic> LogTics(const AxisRange& range);

// Moves sorted places apart where they are nearer than `distance`, each as
// little as may be, least squares: labels that would lie over each other.
std::vector<double> SpreadOut(const std::vector<double>& places,
                              double distance);

}  // namespace rgbd_pose
