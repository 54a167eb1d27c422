#pragma once

#include <ceres/autodiff_cost_function.h>

#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// The point that is seen at a pixel, with derivatives (lens.h): one more Newton
// step from the converged values yields the exact derivatives.
template <typename T>
Eigen::Matrix<T, 2, 1> Undistorted(const CalibratedLens<T>& lens, double u,
                                   double v) {
  double values[kCalibrationSize];
  for (int k = 0; k < kCalibrationSize; ++k) values[k] = lens.theta[k].a;
  const CalibratedLens<double> plain{values, lens.rest};
  const Eigen::Vector2d place = Undistorted(plain, u, v);
  const Eigen::Matrix2d inverse =
      DistortDerivative(plain, place[0], place[1]).inverse();
  const Eigen::Matrix<T, 2, 1> off =
      lens.FromPixel(u, v) - lens.Distort(T(place[0]), T(place[1]));
  Eigen::Matrix<T, 2, 1> result;
  for (int i = 0; i < 2; ++i) {
    result[i] = place[i] + inverse(i, 0) * off[0] + inverse(i, 1) * off[1];
  }
  return result;
}

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
