#include <algorithm>
#include <cstdint>

#include "robust/scale.h"
#include "robust/small_sample.h"

namespace rgbd_pose {
namespace {

// The pairs i < j of sorted values with x_j - x_i <= limit: for each j all i
// from some first one on, which only moves up.
int64_t CountUpTo(const std::vector<double>& x, double limit) {
  int64_t count = 0;
  size_t first = 0;
  for (size_t j = 1; j < x.size(); ++j) {
    while (x[j] - x[first] > limit) ++first;
    count += static_cast<int64_t>(j - first);
  }
  return count;
}

// All differences above `low` and up to `high`.
std::vector<double> DifferencesWithin(const std::vector<double>& x, double low,
                                      double high) {
  std::vector<double> differences;
  size_t first = 0;
  for (size_t j = 1; j < x.size(); ++j) {
    while (x[j] - x[first] > high) ++first;
    for (size_t i = first; i < j && x[j] - x[i] > low; ++i) {
      differences.push_back(x[j] - x[i]);
    }
  }
  return differences;
}

// The shortest interval with h of the sorted values.
double ShortestInterval(const std::vector<double>& x, size_t h) {
  double shortest = x.back() - x.front();
  for (size_t i = 0; i + h <= x.size(); ++i) {
    shortest = std::min(shortest, x[i + h - 1] - x[i]);
  }
  return shortest;
}

// The k-th smallest difference (k >= 1) of sorted values, which is known not to
// exceed `high`. There are too many differences to list, but counting those up
// to a limit is quick: the interval (low, high] that holds the wanted one is
// halved until no more than n differences are in it.
double KthDifference(const std::vector<double>& x, int64_t k, double high) {
  double low = 0.0;
  int64_t below = CountUpTo(x, low);
  if (below >= k) return low;
  int64_t up_to = CountUpTo(x, high);
  while (up_to - below > static_cast<int64_t>(x.size())) {
    const double middle = low + 0.5 * (high - low);
    if (middle <= low || middle >= high) return high;  // all in it are equal
    const int64_t count = CountUpTo(x, middle);
    if (count >= k) {
      high = middle;
      up_to = count;
    } else {
      low = middle;
      below = count;
    }
  }
  std::vector<double> left = DifferencesWithin(x, low, high);
  const auto wanted = left.begin() + (k - below - 1);
  std::nth_element(left.begin(), wanted, left.end());
  return *wanted;
}

}  // namespace

double QnScale(std::vector<double>* values) {
  // The 2.2219 printed in 1993 is a known misprint.
  constexpr double kConsistency = 2.21914;
  constexpr SmallSample kSmallSample = {
      {0.399, 0.994, 0.512, 0.844, 0.611, 0.857, 0.669, 0.872}, 3.8, 1.4};
  const size_t n = values->size();
  if (n < 2) return 0.0;
  std::sort(values->begin(), values->end());
  // Any h values have k differences among themselves.
  const size_t h = n / 2 + 1;
  const int64_t k = static_cast<int64_t>(h) * (h - 1) / 2;
  const double difference =
      KthDifference(*values, k, ShortestInterval(*values, h));
  return kConsistency * kSmallSample.Factor(n) * difference;
}

}  // namespace rgbd_pose
