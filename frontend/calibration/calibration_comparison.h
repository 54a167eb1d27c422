#pragma once

#include <functional>

#include "frontend/calibration/calibration.h"
#include "frontend/calibration/calibration_data.h"

namespace rgbd_pose {

// Compares two solutions on the held-out views and fills in the costs, their
// difference and the residuals. Both sets of views differ only in their depths.
void CompareHeldOut(const CalibrationViews& views_before,
                    const CalibrationState& before,
                    const CalibrationViews& views_after,
                    const CalibrationState& after, CalibrationResult* result);

// Calibrates each half (in time) of a recording with the given free parameters
// and compares the camera found with that of `before` on the other half, which
// the camera found has not seen; poses and depths are solved for with either
// camera. Fills in `unseen_...`; they stay 0 if a half cannot be solved.
// `on_iteration`: see BundleAdjustment.
void CompareOnUnseen(const CalibrationViews& views_before,
                     const CalibrationState& before,
                     const CalibrationViews& views_after,
                     const CalibrationState& after, const FreeParts& is_free,
                     const CalibrationPrior& prior,
                     const std::function<void()>& on_iteration,
                     CalibrationResult* result);

// The RMSE (m) of the motions of pairs against the ground truth; 0 if unknown.
double TruthError(const CalibrationData& data, const CalibrationState& state,
                  const Trajectory& truth);

}  // namespace rgbd_pose
