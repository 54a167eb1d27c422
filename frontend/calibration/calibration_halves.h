#pragma once

#include <array>

#include "costs/calibration/bundle_adjustment.h"

namespace rgbd_pose {

// The views of one half of the keyframes of a recording, and their solution.
struct CalibrationHalf {
  CalibrationViews views;
  CalibrationState state;
};

// Both halves in time of a recording that was solved. Views across the middle
// are in neither.
std::array<CalibrationHalf, 2> HalvesOf(const CalibrationViews& views,
                                        const CalibrationState& solved);

}  // namespace rgbd_pose
