#include <algorithm>

#include "robust/scale.h"
#include "robust/small_sample.h"

namespace rgbd_pose {

double SnScale(std::vector<double>* values) {
  constexpr double kConsistency = 1.1926;
  constexpr SmallSample kSmallSample = {
      {0.743, 1.851, 0.954, 1.351, 0.993, 1.198, 1.005, 1.131}, 0.0, -0.9};
  const size_t n = values->size();
  if (n < 2) return 0.0;
  std::vector<double>& x = *values;
  std::sort(x.begin(), x.end());

  // The inner high median is the distance of x_i to its h-th nearest value,
  // itself included. In sorted order these h values lie side by side: some
  // window from x_l to x_(l+h-1), the one whose farther end is nearest to x_i.
  // As l grows the lower end comes nearer to x_i and the upper end moves away,
  // so the best window is where both distances are equal; it moves up with i.
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
  return kConsistency * kSmallSample.Factor(n) * *low_median;
}

}  // namespace rgbd_pose
