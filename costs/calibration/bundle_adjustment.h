#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <utility>

#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"

namespace rgbd_pose {

// Width of Cauchy's loss on landmarks, in standard deviations.
inline constexpr double kLandmarkLossWidth = 2.5;

// The prior of theta, independent for each parameter.
struct CalibrationPrior {
  CalibrationVector mean, sigma;
};

// A bundle adjustment of keyframes, landmarks and the camera, on one thread:
// several would add up in varying order, and the last digits would vary.
class BundleAdjustment {
 public:
  // `views` must outlive this object. `training_only`: without held-out views.
  // `on_iteration`, unless empty, is called after each iteration of Solve,
  // which passes on what it throws.
  BundleAdjustment(const CalibrationViews& views, const CalibrationPrior& prior,
                   bool training_only, int max_iterations = kMaxIterations,
                   std::function<void()> on_iteration = {})
      : views_(views),
        prior_(prior),
        training_only_(training_only),
        max_iterations_(max_iterations),
        on_iteration_(std::move(on_iteration)) {}

  static constexpr int kMaxIterations = 20;

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
  const std::function<void()> on_iteration_;
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
// numbers each, then y of CalibrationOrigin; landmarks are eliminated.
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

// Residuals have Cauchy's loss.
ReducedCameraSystem MakeReducedCameraSystem(const CalibrationViews& views,
                                            bool training_only,
                                            const CalibrationOrigin& origin,
                                            const CalibrationState& state);

}  // namespace rgbd_pose
