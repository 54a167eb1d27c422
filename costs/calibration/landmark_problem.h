#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// What is solved for, and how much a residual of each kind spreads in the
// sigmas that it came with.
struct CalibrationState {
  std::vector<Rigid3d> world_from_cam;  // of keyframes
  std::vector<double> inverse_depths;   // of landmarks at their anchors
  CalibrationVector theta;
  double pixel_scale = 1.0;
  double depth_scale = 1.0;
};

// How a LandmarkProblem is solved.
struct LandmarkProblemOptions {
  // Of Cauchy's loss, in standard deviations.
  double loss_width = 2.5;
  int max_iterations = 20;
  int threads = 1;
};

// A bundle adjustment of keyframes, landmarks and the camera itself. What of
// the camera is free has a normal prior.
class LandmarkProblem {
 public:
  // `views` must outlive it. Views that are held out take no part if
  // `training_only`.
  LandmarkProblem(const CalibrationViews& views, const CalibrationVector& start,
                  const CalibrationVector& prior, bool training_only,
                  const LandmarkProblemOptions& options);

  // Where all begins: poses of the views, depths as measured.
  CalibrationState Begin() const;

  // Measures the scales of a state's residuals.
  void MeasureScales(CalibrationState* state) const;

  // Solves for all but the scales; `is_free` says which of theta. Returns the
  // cost, NaN where there is no solution.
  double Solve(const std::array<bool, kCalibrationSize>& is_free,
               CalibrationState* state) const;

  // The covariance of theta at a solution, all else being free too: once as the
  // residuals' noise has it, and once as their scatter over the keyframes has
  // it, whatever their noise. Both know the prior. Zero for what is not free;
  // false if they cannot be told.
  bool Covariance(const std::array<bool, kCalibrationSize>& is_free,
                  const CalibrationState& state, CalibrationMatrix* by_noise,
                  CalibrationMatrix* by_scatter) const;

 private:
  struct Blocks;

  bool TakesPart(const LandmarkView& view) const {
    return !(training_only_ && view.is_held_out);
  }
  CalibrationOrigin OriginOf(
      const std::array<bool, kCalibrationSize>& is_free) const;

  const CalibrationViews& views_;
  const CalibrationVector start_, prior_;
  const bool training_only_;
  const LandmarkProblemOptions options_;
};

// What is measured of a landmark in one view, its sigmas as a state has them.
LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const LandmarkView& view, const CalibrationState& state);
LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const CalibrationState& state);

}  // namespace rgbd_pose
