#pragma once

#include <string>

#include "frontend/calibration/calibration.h"

namespace rgbd_pose {

// A gain or a change below this number of standard deviations may be chance.
constexpr double kMinSigmas = 3.0;

// Compares two solutions on the held-out views and fills in the costs, their
// difference and the residuals. Both sets of views differ only in their depths.
void CompareHeldOut(const CalibrationViews& views_before,
                    const CalibrationState& before,
                    const CalibrationViews& views_after,
                    const CalibrationState& after, CalibrationResult* result);

// The RMSE (m) of the motions of pairs against the ground truth; 0 if unknown.
double TruthError(const CalibrationData& data, const CalibrationState& state,
                  const Trajectory& truth);

// Describes in words how far the residuals spread with the camera found.
std::string WhatIsLeft(const CalibrationResult& result);

// Explains why the halves of a recording do not confirm the camera found: they
// contradict each other or cannot be compared. Empty if they confirm it.
std::string WhyUnchecked(const CalibrationSettings& settings,
                         const CalibrationResult& result);

// Describes in words how well the halves of a recording agree.
std::string HalvesInWords(const CalibrationResult& result);

// Explains in words why the camera found is not plausible, or empty.
std::string ImplausibilityReason(const RgbdCamera& first,
                                 const CalibrationResult& result);

// Explains why the camera found is no better than the first one, or empty.
std::string WhyNoBetter(const RgbdCamera& first,
                        const CalibrationSettings& settings,
                        const CalibrationResult& result);

}  // namespace rgbd_pose
