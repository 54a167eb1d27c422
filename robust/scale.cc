#include "robust/scale.h"

#include <cmath>

#include "core/util/named_values.h"
#include "core/util/quantile.h"
#include "robust/small_sample.h"

namespace rgbd_pose {

double MadScale(std::vector<double>* values) {
  // 1 / (upper quartile of the normal distribution).
  constexpr double kConsistency = 1.482602;
  constexpr SmallSample kSmallSample = {
      {1.196, 1.495, 1.363, 1.206, 1.200, 1.140, 1.129, 1.107}, -0.8, -0.8};
  if (values->size() < 2) return 0.0;
  const double centre = QuantileInPlace(values, 0.5);
  for (double& value : *values) value = std::abs(value - centre);
  return kConsistency * kSmallSample.Factor(values->size()) *
         QuantileInPlace(values, 0.5);
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
  return FindNamed(ScaleEstimators(), name);
}

std::vector<std::string> ScaleEstimatorNames() {
  return NamesOf(ScaleEstimators());
}

}  // namespace rgbd_pose
