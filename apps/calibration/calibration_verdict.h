#pragma once

#include <string>

#include "apps/calibration/calibration.h"

namespace rgbd_pose {

// A gain or a change that is less, in standard deviations, may be chance.
constexpr double kMinSigmas = 3.0;

// Fills in what held-out views make of two solutions: costs, their difference,
// residuals. The views of either differ in their depths alone.
void CompareHeldOut(const CalibrationViews& views_before,
                    const CalibrationState& before,
                    const CalibrationViews& views_after,
                    const CalibrationState& after, CalibrationResult* result);

// The RMSE (m) of the motions of pairs against the ground truth; 0 if none can
// be compared.
double TruthError(const CalibrationData& data, const CalibrationState& state,
                  const Trajectory& truth);

// Whether depth was displaced so far that what was found is a first step.
bool IsAnotherPassDue(const CalibrationResult& result);

// How far residuals spread with the camera found, in words.
std::string WhatIsLeft(const CalibrationResult& result);

// Why the halves of a recording contradict each other, in words, or empty.
std::string WhyHalvesDisagree(const CalibrationSettings& settings,
                              const CalibrationResult& result);

// How far the halves of a recording agree, in words.
std::string HalvesInWords(const CalibrationResult& result);

// Why what was found is no camera that can be believed in, in words, or empty.
std::string ImplausibilityReason(const RgbdCamera& first,
                                 const RgbdCamera& found,
                                 const CalibrationResult& result);

// Why a camera that was found is not to be taken instead of the first one, in
// words, or empty.
std::string RejectionReason(const RgbdCamera& first, const RgbdCamera& found,
                            const CalibrationSettings& settings,
                            const CalibrationResult& result);

}  // namespace rgbd_pose
