#pragma once

#include <array>

#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// What is known of theta before, of each parameter by itself.
struct CalibrationPrior {
  CalibrationVector mean, sigma;
};

// A bundle adjustment of keyframes, landmarks and the camera itself. What of
// the camera is free has a normal prior. On one thread: several would add up in
// an order of their own, with other last digits each time.
class BundleAdjustment {
 public:
  // `views` must outlive it. Views that are held out take no part if
  // `training_only`.
  BundleAdjustment(const CalibrationViews& views, const CalibrationPrior& prior,
                   bool training_only, int max_iterations = 20);

  // Where all begins: poses of the views, depths as measured.
  CalibrationState Begin(const CalibrationVector& theta) const;

  // Measures the scales of a state's residuals.
  void MeasureScales(CalibrationState* state) const;

  // Solves for all but the scales; `is_free` says which of theta. Returns the
  // cost, NaN where there is no solution.
  double Solve(const std::array<bool, kCalibrationSize>& is_free,
               CalibrationState* state) const;

  // The covariance of theta at a solution, see LandmarkCovariance.
  bool Covariance(const std::array<bool, kCalibrationSize>& is_free,
                  const CalibrationState& state,
                  CalibrationMatrix* model_covariance,
                  CalibrationMatrix* sandwich_covariance) const;

 private:
  // What is free begins at its mean, the rest stays where it is.
  CalibrationOrigin OriginOf(const std::array<bool, kCalibrationSize>& is_free,
                             const CalibrationVector& theta) const;

  const CalibrationViews& views_;
  const CalibrationPrior prior_;
  const bool training_only_;
  const int max_iterations_;
};

}  // namespace rgbd_pose
