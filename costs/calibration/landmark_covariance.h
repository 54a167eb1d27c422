#pragma once

#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_state.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// The covariance of theta at a solution of a BundleAdjustment, all else being
// free too: once as the residuals' noise has it, and once as their scatter over
// the keyframes has it, whatever their noise. Both know the prior. Zero for
// what `origin` says is not free; false if they cannot be computed.
bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin,
                        const CalibrationState& state,
                        CalibrationMatrix* model_covariance,
                        CalibrationMatrix* sandwich_covariance);

}  // namespace rgbd_pose
