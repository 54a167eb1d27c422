#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <algorithm>

#include "core/geometry/motion.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_residuals.h"

namespace rgbd_pose {

// Width of Cauchy's loss on landmarks, in standard deviations.
inline constexpr double kLandmarkLossWidth = 2.5;

// One residual of a landmark as a Ceres cost function with a hand-written
// Jacobian, by [pose of the anchor, pose of the view, inverse depth, y].
template <typename Residual>
class LandmarkBlock final
    : public ceres::SizedCostFunction<Residual::kRows, 6, 6, 1,
                                      kCalibrationSize> {
 public:
  // All must outlive the block. Blocks that share a pose are not thread-safe:
  // its derivatives are computed once for all of them.
  LandmarkBlock(const LinearizationPoint& anchor,
                const LinearizationPoint& view, const CalibrationOrigin& origin,
                const LandmarkData& data)
      : anchor_(anchor), view_(view), origin_(origin), data_(data) {}

  bool Evaluate(double const* const* x, double* residuals,
                double** jacobians) const override {
    const CalibrationVector theta = origin_.At(x[3]);
    const MotionDerivatives& anchor = anchor_.CachedDerivativesAt(x[0]);
    const MotionDerivatives& view = view_.CachedDerivativesAt(x[1]);
    if (jacobians == nullptr) {
      Residual::template Residual<double>(anchor, view, x[2][0], theta.data(),
                                          data_, residuals);
      return true;
    }
    constexpr int kRows = Residual::kRows;
    LandmarkDerivatives<kRows> J;
    Residual::Jacobian(anchor, view, x[2][0], theta.data(), data_, residuals,
                       &J);
    // All are stored row by row, as Ceres needs them.
    const auto give = [&](int block, const auto& derivatives) {
      if (jacobians[block] == nullptr) return;
      std::copy_n(derivatives.data(), derivatives.size(), jacobians[block]);
    };
    give(0, J.anchor);
    give(1, J.view);
    give(2, J.inverse_depth);
    const decltype(J.theta) by_y = J.theta * origin_.width.asDiagonal();
    give(3, by_y);
    return true;
  }

 private:
  const LinearizationPoint& anchor_;
  const LinearizationPoint& view_;
  const CalibrationOrigin& origin_;
  const LandmarkData& data_;
};

// The whitened error of a KnownDistance and its derivatives by both poses and
// theta: |P_a - P_b| with P = C + R^T (factor * in).
struct KnownDistanceError {
  double r = 0.0;
  Eigen::Matrix<double, 1, 6> a, b;
  double by_factor = 0.0;

  KnownDistanceError(const MotionDerivatives& pose_a,
                     const MotionDerivatives& pose_b, double factor,
                     const KnownDistance& known) {
    const Eigen::Vector3d in_a = factor * known.in_a;
    const Eigen::Vector3d in_b = factor * known.in_b;
    const Eigen::Vector3d apart = pose_a.C + pose_a.R.transpose() * in_a -
                                  pose_b.C - pose_b.R.transpose() * in_b;
    const double length = apart.norm();
    const double weight = 1.0 / known.sigma;
    r = (length - known.metres) * weight;
    const Eigen::RowVector3d along =
        (length > 0.0 ? Eigen::Vector3d(apart / length)
                      : Eigen::Vector3d::Zero().eval())
            .transpose() *
        weight;
    for (int k = 0; k < 3; ++k) {
      a[k] = along * (pose_a.dR[k].transpose() * in_a);
      b[k] = -along * (pose_b.dR[k].transpose() * in_b);
    }
    a.tail<3>() = along;
    b.tail<3>() = -along;
    by_factor = along * (pose_a.R.transpose() * known.in_a -
                         pose_b.R.transpose() * known.in_b);
  }
};

// The same as a Ceres cost function of [pose of a, pose of b, y].
class KnownDistanceBlock final
    : public ceres::SizedCostFunction<1, 6, 6, kCalibrationSize> {
 public:
  // All must outlive the block.
  KnownDistanceBlock(const LinearizationPoint& a, const LinearizationPoint& b,
                     const CalibrationOrigin& origin,
                     const KnownDistance& known)
      : a_(a), b_(b), origin_(origin), known_(known) {}

  bool Evaluate(double const* const* x, double* residuals,
                double** jacobians) const override {
    const KnownDistanceError error(a_.DerivativesAt(x[0]),
                                   b_.DerivativesAt(x[1]),
                                   origin_.At(x[2])[kDepthFactor], known_);
    residuals[0] = error.r;
    if (jacobians == nullptr) return true;
    for (int k = 0; k < 6; ++k) {
      if (jacobians[0] != nullptr) jacobians[0][k] = error.a[k];
      if (jacobians[1] != nullptr) jacobians[1][k] = error.b[k];
    }
    if (jacobians[2] == nullptr) return true;
    for (int k = 0; k < kCalibrationSize; ++k) jacobians[2][k] = 0.0;
    jacobians[2][kDepthFactor] = error.by_factor * origin_.width[kDepthFactor];
    return true;
  }

 private:
  const LinearizationPoint& a_;
  const LinearizationPoint& b_;
  const CalibrationOrigin& origin_;
  const KnownDistance& known_;
};

}  // namespace rgbd_pose
