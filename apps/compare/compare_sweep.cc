#include "apps/compare/compare_sweep.h"

#include <algorithm>
#include <cmath>

#include "core/util/quantile.h"

namespace rgbd_pose {

int MedianBandRank(int count) {
  constexpr double kTail = 0.025;  // on each side
  double below = 0.0;  // probability that at most `rank` values are below
  for (int rank = 0; rank < count / 2; ++rank) {
    below += std::exp(std::lgamma(count + 1.0) - std::lgamma(rank + 1.0) -
                      std::lgamma(count - rank + 1.0) - count * std::log(2.0));
    if (below > kTail) return std::max(0, rank - 1);
  }
  return 0;
}

MedianBand FindMedianBand(std::vector<double> values) {
  if (values.empty()) return {NAN, NAN, NAN, NAN};
  std::sort(values.begin(), values.end());
  const int count = static_cast<int>(values.size());
  const int rank = MedianBandRank(count);
  return {Median(values), values[rank], values[count - 1 - rank],
          values[std::max(0, (9 * count + 9) / 10 - 1)]};
}

std::vector<SweepMethod> SweepMethods(const std::vector<std::string>& losses) {
  std::vector<SweepMethod> methods;
  for (const std::string& loss : losses) {
    for (const char* schedule : {"gnc", "direct"}) {
      for (const bool ransac : {false, true}) {
        methods.push_back({loss, schedule, ransac});
      }
    }
  }
  return methods;
}

std::vector<SweepCell> CellsOf(const std::vector<SweepCell>& cells,
                               const SweepMethod& method) {
  std::vector<SweepCell> chosen;
  for (const SweepCell& cell : cells) {
    if (cell.method == method) chosen.push_back(cell);
  }
  return chosen;
}

std::vector<std::string> LossesOf(const std::vector<SweepCell>& cells) {
  std::vector<std::string> losses;
  for (const SweepCell& cell : cells) {
    if (losses.empty() || losses.back() != cell.method.loss) {
      losses.push_back(cell.method.loss);
    }
  }
  return losses;
}

}  // namespace rgbd_pose
