#pragma once

#include <ceres/loss_function.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// A row of the table of M-estimators. With Zhang's rho(x) (Image and Vision
// Computing 15, 1997) a Ceres loss is 2 rho(sqrt s), s = |r|^2 of one block of
// whitened residuals; so a width counts sigmas.
struct MEstimator {
  static constexpr int kMaxDimension = 6;

  std::string_view name;
  std::string_view formula;  // weight w(x) of the norm x, c the width
  bool is_redescending;      // far matches lose all influence

  // Makes the loss of a given width; null: no loss (least squares).
  std::unique_ptr<ceres::LossFunction> (*make)(double width);

  // Width for 95 % efficiency on normal noise, by the number of independent
  // components of the residual, 1 to 6.
  std::array<double, kMaxDimension> width95;

  double Width95(int dimension) const;

  // The loss at its 95 % width; null: no loss.
  std::unique_ptr<ceres::LossFunction> MakeLoss(int dimension) const;
};

// All M-estimators.
const std::vector<MEstimator>& MEstimators();

// The row of that name, or null.
const MEstimator* FindMEstimator(std::string_view name);

// The names of all rows.
std::vector<std::string> MEstimatorNames();

}  // namespace rgbd_pose
