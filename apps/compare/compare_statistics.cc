#include "apps/compare/compare_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/util/format.h"
#include "core/util/quantile.h"

namespace rgbd_pose {

int MedianBandRank(int count) {
  constexpr double kTail = 0.025;  // of each side
  double below = 0.0;  // probability that at most `rank` values are below
  for (int rank = 0; rank < count / 2; ++rank) {
    below += std::exp(std::lgamma(count + 1.0) - std::lgamma(rank + 1.0) -
                      std::lgamma(count - rank + 1.0) - count * std::log(2.0));
    if (below > kTail) return std::max(0, rank - 1);
  }
  return 0;
}

MedianBand FindMedianBand(std::vector<double> values) {
  if (values.empty()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, nan};
  }
  std::sort(values.begin(), values.end());
  const int count = static_cast<int>(values.size());
  const int rank = MedianBandRank(count);
  MedianBand band;
  band.median = Median(values);
  band.low = values[rank];
  band.high = values[count - 1 - rank];
  band.p90 = values[std::max(0, (9 * count + 9) / 10 - 1)];
  return band;
}

std::string FormatBand(const MedianBand& band) {
  return Format("%.3g [%.3g, %.3g]", band.median, band.low, band.high);
}

}  // namespace rgbd_pose
