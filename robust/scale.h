#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// Robust estimators of the standard deviation of normally distributed values,
// up to half of which may be outliers. Input: finite values, which may be
// reordered. Output: sigma >= 0 in their unit, consistent for large n and
// nearly unbiased for small n; 0 for fewer than two values or if more than half
// of them are equal. All three take O(n log n).

// Median absolute deviation from the median. Efficiency 37 %.
double MadScale(std::vector<double>* values);

// Rousseeuw and Croux (JASA 88, 1993): the median over i of the median over j
// of |x_i - x_j|; needs no centre and no symmetry. Efficiency 58 %.
double SnScale(std::vector<double>* values);

// By the same authors: roughly the lower quartile of all |x_i - x_j|, i < j.
// Efficiency 82 %.
double QnScale(std::vector<double>* values);

// A row of the table of scale estimators.
struct ScaleEstimator {
  std::string_view name;                            // as given to programs
  double (*estimate)(std::vector<double>* values);  // null: sigma is 1
};

// The table of all scale estimators.
const std::vector<ScaleEstimator>& ScaleEstimators();

// The row with this name, or null.
const ScaleEstimator* FindScaleEstimator(std::string_view name);

// The names of all scale estimators.
std::vector<std::string> ScaleEstimatorNames();

}  // namespace rgbd_pose
