#include "robust/m_estimator.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

template <typename Loss>
std::unique_ptr<ceres::LossFunction> Make(double width) {
  return std::make_unique<Loss>(width);
}

}  // namespace

double MEstimator::Width95(int dimension) const {
  return width95[std::clamp(dimension, 1, kMaxDimension) - 1];
}

std::unique_ptr<ceres::LossFunction> MEstimator::MakeLoss(int dimension) const {
  return make != nullptr ? make(Width95(dimension)) : nullptr;
}

// Widths: found by quadrature over the chi distribution; a test finds them
// again (tests/m_estimator_test.cc).
const std::vector<MEstimator>& MEstimators() {
  static const std::vector<MEstimator>& rows = *new std::vector<MEstimator>{
      {"none", "1", false, nullptr, {1, 1, 1, 1, 1, 1}},
      {"huber",
       "1 if x <= c, c / x beyond",
       false,
       Make<ceres::HuberLoss>,
       {1.3450, 1.5011, 1.6280, 1.7311, 1.8120, 1.8693}},
      {"cauchy",
       "1 / (1 + (x/c)^2)",
       true,
       Make<ceres::CauchyLoss>,
       {2.3849, 2.5486, 2.6656, 2.7516, 2.8154, 2.8624}},
      {"tukey",
       "(1 - (x/c)^2)^2 if x <= c, 0 beyond",
       true,
       Make<ceres::TukeyLoss>,
       {4.6851, 5.1230, 5.4902, 5.8103, 6.0963, 6.3562}},
  };
  return rows;
}

const MEstimator* FindMEstimator(std::string_view name) {
  for (const MEstimator& row : MEstimators()) {
    if (row.name == name) return &row;
  }
  return nullptr;
}

std::vector<std::string> MEstimatorNames() {
  std::vector<std::string> names;
  for (const MEstimator& row : MEstimators()) names.emplace_back(row.name);
  return names;
}

}  // namespace rgbd_pose
