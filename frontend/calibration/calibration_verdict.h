#pragma once

#include <string>

#include "frontend/calibration/calibration.h"

namespace rgbd_pose {

// A gain or a change below this number of standard deviations may be chance.
constexpr double kMinSigmas = 3.0;

// Describes in words how far the residuals spread with the camera found.
std::string WhatIsLeft(const CalibrationResult& result);

// Explains why the halves of a recording do not confirm the camera found: they
// contradict each other or cannot be compared. Empty if they confirm it.
std::string WhyUnchecked(const CalibrationSettings& settings,
                         const CalibrationResult& result);

// Describes in words how well the halves of a recording agree.
std::string HalvesInWords(const CalibrationResult& result);

// Describes in words how well cameras fit what they have not seen.
std::string UnseenInWords(const CalibrationResult& result);

// Explains in words why the camera found is not plausible, or empty.
std::string ImplausibilityReason(const RgbdCamera& first,
                                 const CalibrationResult& result);

// Explains why the camera found is no better than the first one, or empty.
std::string WhyNoBetter(const RgbdCamera& first,
                        const CalibrationSettings& settings,
                        const CalibrationResult& result);

}  // namespace rgbd_pose
