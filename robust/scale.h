#pragma once

#include <string_view>
#include <vector>

namespace rgbd_pose {

// A robust estimator of the standard deviation of normally distributed values,
// up to half of which may be outliers. Input: finite values, which may be
// reordered. Output: sigma >= 0 in their unit, consistent for large n and
// nearly unbiased for small n; 0 for fewer than two values or if more than half
// of them are equal. All take O(n log n).
struct ScaleEstimator {
  std::string_view name;                            // as given to programs
  double (*estimate)(std::vector<double>* values);  // null: sigma is 1
};

// All scale estimators, with their efficiency:
//   fixed  1
//   mad    median absolute deviation from the median; 37 %
//   sn     the median over i of the median over j of |x_i - x_j| (Rousseeuw and
//          Croux, JASA 88, 1993); needs no centre and no symmetry; 58 %
//   qn     roughly the lower quartile of all |x_i - x_j|, i < j (as sn); 82 %
const std::vector<ScaleEstimator>& ScaleEstimators();

// The estimator mad.
double MadScale(std::vector<double>* values);

}  // namespace rgbd_pose
