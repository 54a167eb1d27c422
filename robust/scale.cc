#include "robust/scale.h"

#include <algorithm>
#include <cmath>

#include "robust/small_sample.h"

namespace rgbd_pose {
namespace {

// The mean of the two middle values if their number is even.
double Median(std::vector<double>* values) {
  const auto middle = values->begin() + values->size() / 2;
  std::nth_element(values->begin(), middle, values->end());
  if (values->size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values->begin(), middle));
}

}  // namespace

double MadScale(std::vector<double>* values) {
  // 1 / (upper quartile of the normal distribution).
  constexpr double kConsistency = 1.482602;
  constexpr SmallSample kSmallSample = {
      {1.196, 1.495, 1.363, 1.206, 1.200, 1.140, 1.129, 1.107}, -0.8, -0.8};
  if (values->size() < 2) return 0.0;
  const double centre = Median(values);
  for (double& value : *values) value = std::abs(value - centre);
  return kConsistency * kSmallSample.Factor(values->size()) * Median(values);
}

const std::vector<ScaleEstimator>& ScaleEstimators() {
  static const std::vector<ScaleEstimator>& rows =
      *new std::vector<ScaleEstimator>{
          {"fixed", nullptr},
          {"mad", MadScale},
          {"sn", SnScale},
          {"qn", QnScale},
      };
  return rows;
}

const ScaleEstimator* FindScaleEstimator(std::string_view name) {
  for (const ScaleEstimator& row : ScaleEstimators()) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

std::vector<std::string> ScaleEstimatorNames() {
  std::vector<std::string> names;
  for (const ScaleEstimator& row : ScaleEstimators()) {
    names.emplace_back(row.name);
  }
  return names;
}

}  // namespace rgbd_pose
