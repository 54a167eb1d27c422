#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <vector>

#include "core/geometry/motion.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_residuals.h"

namespace rgbd_pose {

// Width of Cauchy's loss on landmarks, in standard deviations.
inline constexpr double kLandmarkLossWidth = 2.5;

// The solver's calibration parameters y, in standard deviations of the prior:
// theta = start + width . y. Fixed parameters have width 0.
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

// One residual of a landmark as a Ceres cost function with a hand-written
// Jacobian, by [pose of the anchor, pose of the view, inverse depth, y].
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

// The prior of theta, independent for each parameter.
struct CalibrationPrior {
  CalibrationVector mean, sigma;
};

// A bundle adjustment of keyframes, landmarks and the camera, on one thread:
// several would add up in varying order, and the last digits would vary.
class BundleAdjustment {
 public:
  // `views` must outlive this object. With `training_only`, views that are held
  // out are not used.
  BundleAdjustment(const CalibrationViews& views, const CalibrationPrior& prior,
                   bool training_only, int max_iterations = 20)
      : views_(views),
        prior_(prior),
        training_only_(training_only),
        max_iterations_(max_iterations) {}

  // The initial state: the poses of the views, the depths as measured.
  CalibrationState Begin(const CalibrationVector& theta) const;

  // Measures the scales of a state's residuals.
  void MeasureScales(CalibrationState* state) const;

  // Solves for everything but the scales; `is_free` selects parameters of
  // theta. Returns the cost, NaN if there is no solution.
  double Solve(const FreeParts& is_free, CalibrationState* state) const;

  // The variances of theta at a solution, each the larger one of the two from
  // LandmarkCovariance; nothing if they cannot be computed.
  std::optional<CalibrationVector> Variances(
      const FreeParts& is_free, const CalibrationState& state) const;

 private:
  // Free parameters count from their prior mean, the others keep their value.
  CalibrationOrigin OriginOf(const FreeParts& is_free,
                             const CalibrationVector& theta) const;

  const CalibrationViews& views_;
  const CalibrationPrior prior_;
  const bool training_only_;
  const int max_iterations_;
};

// The covariance of theta at a solution of a BundleAdjustment, with all else
// free: from the noise of the residuals (model) and from their scatter over the
// keyframes, whatever their noise (sandwich). Both include the prior. Zero for
// parameters that `origin` fixes. Returns false if they cannot be computed.
bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin,
                        const CalibrationState& state,
                        CalibrationMatrix* model_covariance,
                        CalibrationMatrix* sandwich_covariance);

// The normal equations of a bundle adjustment at a state, without known
// distances and the prior. The unknowns are all poses but the first, six
// numbers each, then y of CalibrationOrigin; the depths of landmarks are
// eliminated.
struct ReducedCameraSystem {
  Eigen::MatrixXd hessian;  // only the lower triangle is valid

  // One column per keyframe: the gradient of the landmarks anchored there.
  Eigen::MatrixXd gradients;

  // Residuals lose weight as they grow, so the gradients change less with the
  // unknowns than `hessian`, by slope_p / weight_p: sums of rho' p + 2 s rho''
  // and of rho' p over residuals with p rows and s = |r|^2.
  double slope_p = 0.0, weight_p = 0.0;

  // Index of a pose among the unknowns; negative for the first, a constant.
  static int PlaceOfPose(int keyframe) { return 6 * (keyframe - 1); }
  int PlaceOfY() const {
    return static_cast<int>(hessian.rows()) - kCalibrationSize;
  }
};

// `poses` must be the poses of `state`. Residuals have Cauchy's loss.
ReducedCameraSystem MakeReducedCameraSystem(
    const CalibrationViews& views, bool training_only,
    const CalibrationOrigin& origin, const CalibrationState& state,
    const std::vector<MotionDerivatives>& poses);

}  // namespace rgbd_pose
