#include "robust/scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// The factor that makes a scale estimator unbiased for a small sample: one of
// `factors` for n from 2 to 9, n / (n + shift) above. From Croux and Rousseeuw,
// Time-Efficient Algorithms for Two Highly Robust Estimators of Scale (COMPSTAT
// 1992); tests/robust/scale_test.cc confirms them by simulation.
double SmallSampleFactor(size_t n, const std::array<double, 8>& factors,
                         double shift_even, double shift_odd) {
  if (n < 10) return factors[n - 2];
  const double size = static_cast<double>(n);
  return size / (size + (n % 2 == 0 ? shift_even : shift_odd));
}

// Counts the pairs i < j of sorted values with x_j - x_i <= limit. For each j
// these are all i from a first one on, which only increases with j.
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

// The k-th smallest difference (k >= 1) of sorted values. As those up to a
// limit are counted quickly, the interval (low, high] that contains it is
// halved until it has at most n differences.
double KthDifference(const std::vector<double>& x, int64_t k) {
  double low = 0.0, high = x.back() - x.front();
  int64_t below = CountUpTo(x, low);
  if (below >= k) return low;
  int64_t up_to = CountUpTo(x, high);
  while (up_to - below > static_cast<int64_t>(x.size())) {
    const double middle = low + 0.5 * (high - low);
    if (middle <= low || middle >= high) return high;  // all are equal
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

double SnScale(std::vector<double>* values) {
  constexpr double kConsistency = 1.1926;
  const size_t n = values->size();
  if (n < 2) return 0.0;
  std::vector<double>& x = *values;
  std::sort(x.begin(), x.end());

  // The inner high median is the distance of x_i to its h-th nearest value,
  // itself included. These h values are contiguous in sorted order: they form
  // the window from x_l to x_(l+h-1) whose farther end is nearest to x_i. As l
  // grows the lower end approaches x_i and the upper end moves away, so the
  // best window is where both distances are equal; it moves up with i.
  const size_t h = n / 2 + 1;
  std::vector<double> medians(n);
  size_t l = 0;
  for (size_t i = 0; i < n; ++i) {
    while (l < n - h && x[i] - x[l] > x[l + h - 1] - x[i]) ++l;
    medians[i] = std::max(x[i] - x[l], x[l + h - 1] - x[i]);
    if (l > 0) medians[i] = std::min(medians[i], x[i] - x[l - 1]);
  }

  const auto low_median = medians.begin() + (n + 1) / 2 - 1;
  std::nth_element(medians.begin(), low_median, medians.end());
  constexpr std::array kFactors = {0.743, 1.851, 0.954, 1.351,
                                   0.993, 1.198, 1.005, 1.131};
  return kConsistency * SmallSampleFactor(n, kFactors, 0.0, -0.9) * *low_median;
}

double QnScale(std::vector<double>* values) {
  // The 2.2219 printed in 1993 is a known misprint.
  constexpr double kConsistency = 2.21914;
  const size_t n = values->size();
  if (n < 2) return 0.0;
  std::sort(values->begin(), values->end());
  const int64_t h = n / 2 + 1;
  const double difference = KthDifference(*values, h * (h - 1) / 2);
  constexpr std::array kFactors = {0.399, 0.994, 0.512, 0.844,
                                   0.611, 0.857, 0.669, 0.872};
  return kConsistency * SmallSampleFactor(n, kFactors, 3.8, 1.4) * difference;
}

}  // namespace

double MadScale(std::vector<double>* values) {
  // 1 / (upper quartile of the normal distribution).
  constexpr double kConsistency = 1.482602;
  if (values->size() < 2) return 0.0;
  const double centre = QuantileInPlace(values, 0.5);
  for (double& value : *values) value = std::abs(value - centre);
  constexpr std::array kFactors = {1.196, 1.495, 1.363, 1.206,
                                   1.200, 1.140, 1.129, 1.107};
  return kConsistency *
         SmallSampleFactor(values->size(), kFactors, -0.8, -0.8) *
         QuantileInPlace(values, 0.5);
}

const std::vector<ScaleEstimator>& ScaleEstimators() {
  static const auto& rows = *new std::vector<ScaleEstimator>{
      {"fixed", nullptr},
      {"mad", MadScale},
      {"sn", SnScale},
      {"qn", QnScale},
  };
  return rows;
}

}  // namespace rgbd_pose
