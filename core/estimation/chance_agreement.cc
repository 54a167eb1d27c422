#include "core/estimation/chance_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbd_pose {
namespace {

// The logarithm of a number of false alarms that is low enough.
constexpr double kProof = -36.0;

// Wrong matches are rarely nearer, in limits: at 3 m a Kinect's is 5 cm.
constexpr double kLeastExtent = 10.0;

// Residuals far below the noise are small by chance, in limits.
constexpr double kLeastWidth = 0.3;

// The logarithm of the number of ways to choose k of n.
double LogChoices(double n, double k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

}  // namespace

double FalseAlarms(double limit, int parameters,
                   std::vector<MatchAgreement>* agreements) {
  std::vector<MatchAgreement>& all = *agreements;
  double least = std::numeric_limits<double>::infinity();
  if (all.empty()) return least;
  std::sort(all.begin(), all.end(),
            [](const MatchAgreement& a, const MatchAgreement& b) {
              return a.width < b.width;
            });
  const auto fewest =
      std::min_element(all.begin(), all.end(),
                       [](const MatchAgreement& a, const MatchAgreement& b) {
                         return a.rows < b.rows;
                       });
  const double rows = std::max(fewest->rows, 1);
  const auto end = std::upper_bound(
      all.begin(), all.end(), limit,
      [](double w, const MatchAgreement& match) { return w < match.width; });
  const double extent =
      end == all.end()
          ? kLeastExtent
          : ExtentOfWrong((end + (all.end() - end) / 2)->width, rows);
  const double n = static_cast<double>(all.size());
  const double needed = std::ceil(parameters / rows);
  for (double k = static_cast<double>(end - all.begin()); k > needed; --k) {
    const double width =
        std::max(all[static_cast<size_t>(k) - 1].width, kLeastWidth);
    const double alarms =
        std::log(n - needed) + LogChoices(n, k) + LogChoices(k, needed) +
        rows * (k - needed) * std::log(std::min(width / extent, 1.0));
    least = std::min(least, alarms);
    // All of the larger sets of many matches prove more than enough.
    if (least < kProof) break;
  }
  return std::exp(least);
}

// Half of the wrong ones, uniform in a ball, are within the median.
double ExtentOfWrong(double median_width, double rows) {
  return std::max(kLeastExtent, median_width * std::pow(2.0, 1.0 / rows));
}

}  // namespace rgbd_pose
