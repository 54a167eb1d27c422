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
// whitened residuals; so a width counts sigmas. All have R'' <= 0, and R of k
// times the width is k^2 R(s / k^2) (core/estimation/batch_loss.h).
struct MEstimator {
  // The most independent components there are widths for.
  static constexpr int kMaxDimension = 6;

  std::string_view name;     // as programs take it
  std::string_view formula;  // weight w(x) of the norm x, c the width

  // Makes the loss of a given width; null: no loss (least squares).
  std::unique_ptr<ceres::LossFunction> (*make)(double width);

  // Width by the number of independent components of the residual, 1 to 6: for
  // 95 % efficiency on normal noise if tuned, else 1.
  bool is_tuned;
  std::array<double, kMaxDimension> width95;

  // The width for a residual of so many components, at least 1; of more than 6
  // that of 6.
  double Width95(int dimension) const;

  // The loss at that width; null: no loss.
  std::unique_ptr<ceres::LossFunction> MakeLoss(int dimension) const {
    return make != nullptr ? make(Width95(dimension)) : nullptr;
  }
};

// All M-estimators.
const std::vector<MEstimator>& MEstimators();

// The row of that name, or null.
const MEstimator* FindMEstimator(std::string_view name);

// The names of all rows.
std::vector<std::string> MEstimatorNames();

// A loss as programs take it: a name, or a name and a width in sigmas from
// 0.001 to 1000 for residuals of any number of components, "huber(1.5)".
struct NamedLoss {
  const MEstimator* row = nullptr;  // never null from ParseLoss
  double width = 0.0;               // 0: see Width95

  // For a residual of so many components.
  double Width(int dimension) const {
    return width > 0.0 ? width : row->Width95(dimension);
  }
  // At that width; null: no loss.
  std::unique_ptr<ceres::LossFunction> Make(int dimension) const {
    return row->make != nullptr ? row->make(Width(dimension)) : nullptr;
  }
};

// Throws InputError with what there is.
NamedLoss ParseLoss(const std::string& text);

}  // namespace rgbd_pose
