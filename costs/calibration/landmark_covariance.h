#pragma once

#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_state.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// The covariance of theta at a solution of a LandmarkProblem, all else being
// free too: once as the residuals' noise has it, and once as their scatter over
// the keyframes has it, whatever their noise. Both know the prior. Zero for
// what `origin` says is not free; false if they cannot be told.
bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin, double loss_width,
                        const CalibrationState& state,
                        CalibrationMatrix* by_noise,
                        CalibrationMatrix* by_scatter);

}  // namespace rgbd_pose
