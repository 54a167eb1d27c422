#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "core/geometry/motion.h"
#include "costs/calibration/landmark_residuals.h"

namespace rgbd_pose {

// Width of Cauchy's loss on landmarks, in standard deviations.
inline constexpr double kLandmarkLossWidth = 2.5;

// The solver's calibration parameters y: theta = start + width . y, where what
// is not free has a width of 0. Counted in standard deviations of what is known
// before, they are of one size.
struct CalibrationOrigin {
  CalibrationVector start;
  CalibrationVector width;

  template <typename T>
  Eigen::Matrix<T, kCalibrationSize, 1> At(const T* y) const {
    Eigen::Matrix<T, kCalibrationSize, 1> theta;
    for (int k = 0; k < kCalibrationSize; ++k) {
      theta[k] = start[k] + width[k] * y[k];
    }
    return theta;
  }
};

// One residual of a landmark as a Ceres cost function with its hand-written
// Jacobian, in [pose of the anchor, pose of the view, inverse depth, y].
template <typename Residual>
class LandmarkBlock final
    : public ceres::SizedCostFunction<Residual::kRows, 6, 6, 1,
                                      kCalibrationSize> {
 public:
  // All must outlive the block.
  LandmarkBlock(const LinearizationPoint& anchor,
                const LinearizationPoint& view, const CalibrationOrigin& origin,
                const LandmarkData& data)
      : anchor_(anchor), view_(view), origin_(origin), data_(data) {}

  bool Evaluate(double const* const* x, double* residuals,
                double** jacobians) const override {
    const CalibrationVector theta = origin_.At(x[3]);
    if (jacobians == nullptr) {
      Residual::Residual(anchor_.PoseAt(x[0]), view_.PoseAt(x[1]), x[2][0],
                         theta.data(), data_, residuals);
      return true;
    }
    constexpr int kRows = Residual::kRows;
    LandmarkDerivatives<kRows> J;
    Residual::Jacobian(anchor_.DerivativesAt(x[0]), view_.DerivativesAt(x[1]),
                       x[2][0], theta.data(), data_, residuals, &J);
    const auto give = [&](int block, const auto& derivatives) {
      double* to = jacobians[block];
      if (to == nullptr) return;
      for (int row = 0; row < kRows; ++row) {
        for (int k = 0; k < derivatives.cols(); ++k)
          *to++ = derivatives(row, k);
      }
    };
    give(0, J.anchor);
    give(1, J.view);
    give(2, J.inverse_depth);
    give(3, (J.theta * origin_.width.asDiagonal()).eval());
    return true;
  }

 private:
  const LinearizationPoint& anchor_;
  const LinearizationPoint& view_;
  const CalibrationOrigin& origin_;
  const LandmarkData& data_;
};

}  // namespace rgbd_pose
