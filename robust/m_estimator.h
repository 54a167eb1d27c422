#pragma once

#include <ceres/loss_function.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/util/named_values.h"

namespace rgbd_pose {

// A row of the table of M-estimators. With Zhang's rho(x) (Image and Vision
// Computing 15, 1997) a Ceres loss is R(s) = 2 rho(sqrt s), s = |r|^2 of a
// block of whitened residuals; hence widths are in sigmas. All have R'' <= 0.
// With k times the width, R becomes k^2 R(s / k^2)
// (core/estimation/batch_loss.h).
struct MEstimator {
  // The largest number of independent components with known widths.
  static constexpr int kMaxDimension = 6;

  std::string_view name;     // as given to programs
  std::string_view formula;  // weight w(x) of the norm x; c is the width

  // Makes the loss of a given width; null for least squares.
  std::unique_ptr<ceres::LossFunction> (*make)(double width);

  // Width by the number of independent components of the residual, 1 to 6:
  // tuned to 95 % efficiency under normal noise, or 1 for all.
  std::array<double, kMaxDimension> width95 = {1, 1, 1, 1, 1, 1};

  // The width for a residual of `dimension` components, limited to 1 to 6.
  double Width95(int dimension) const {
    return width95[std::clamp(dimension, 1, kMaxDimension) - 1];
  }
};

// The table of all M-estimators, for FindNamed.
const std::vector<MEstimator>& MEstimators();

// The names of all M-estimators.
std::vector<std::string> MEstimatorNames();

// A loss as given to programs: a name, or a name and a width in sigmas from
// 0.001 to 1000 for residuals of any dimension, such as "huber(1.5)".
struct NamedLoss {
  const MEstimator* row = nullptr;  // never null if made by ParseLoss
  double width = 0.0;               // 0: use Width95

  // The width for residuals of this dimension, in sigmas.
  double Width(int dimension) const {
    return width > 0.0 ? width : row->Width95(dimension);
  }
  // The loss at that width; null for least squares.
  std::unique_ptr<ceres::LossFunction> Make(int dimension) const {
    return row->make != nullptr ? row->make(Width(dimension)) : nullptr;
  }
};

// Throws InputError with the known names or the valid widths.
NamedLoss ParseLoss(const std::string& text);

}  // namespace rgbd_pose
