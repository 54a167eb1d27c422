#pragma once

#include <array>

#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// The prior of theta, independent for each parameter.
struct CalibrationPrior {
  CalibrationVector mean, sigma;
};

// A bundle adjustment of keyframes, landmarks and the camera. The free
// parameters of the camera have a normal prior. It runs on one thread: several
// threads would add up in varying order, and the last digits would vary.
class BundleAdjustment {
 public:
  // `views` must outlive this object. With `training_only`, views that are held
  // out are not used.
  BundleAdjustment(const CalibrationViews& views, const CalibrationPrior& prior,
                   bool training_only, int max_iterations = 20);

  // The initial state: the poses of the views, the depths as measured.
  CalibrationState Begin(const CalibrationVector& theta) const;

  // Measures the scales of a state's residuals.
  void MeasureScales(CalibrationState* state) const;

  // Solves for everything but the scales; `is_free` selects parameters of
  // theta. Returns the cost, NaN if there is no solution.
  double Solve(const std::array<bool, kCalibrationSize>& is_free,
               CalibrationState* state) const;

  // The covariance of theta at a solution, see LandmarkCovariance.
  bool Covariance(const std::array<bool, kCalibrationSize>& is_free,
                  const CalibrationState& state,
                  CalibrationMatrix* model_covariance,
                  CalibrationMatrix* sandwich_covariance) const;

 private:
  // Free parameters count from their prior mean, the others keep their value.
  CalibrationOrigin OriginOf(const std::array<bool, kCalibrationSize>& is_free,
                             const CalibrationVector& theta) const;

  const CalibrationViews& views_;
  const CalibrationPrior prior_;
  const bool training_only_;
  const int max_iterations_;
};

}  // namespace rgbd_pose
