#pragma once

#include <ceres/autodiff_cost_function.h>

#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// The residual of a LandmarkBlock by automatic differentiation.
template <typename Residual>
class LandmarkOracle {
 public:
  LandmarkOracle(const LinearizationPoint& anchor,
                 const LinearizationPoint& view,
                 const CalibrationOrigin& origin, const LandmarkData& data)
      : anchor_(anchor), view_(view), origin_(origin), data_(data) {}

  template <typename T>
  bool operator()(const T* anchor, const T* view, const T* d, const T* y,
                  T* residuals) const {
    const auto theta = origin_.At(y);
    Residual::Residual(anchor_.PoseAt(anchor), view_.PoseAt(view), d[0],
                       theta.data(), data_, residuals);
    return true;
  }

 private:
  const LinearizationPoint& anchor_;
  const LinearizationPoint& view_;
  const CalibrationOrigin& origin_;
  const LandmarkData& data_;
};

template <typename Residual>
using LandmarkOracleBlock =
    ceres::AutoDiffCostFunction<LandmarkOracle<Residual>, Residual::kRows, 6, 6,
                                1, kCalibrationSize>;

}  // namespace rgbd_pose
