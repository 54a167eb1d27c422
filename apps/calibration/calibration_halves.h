#pragma once

#include <array>
#include <optional>
#include <vector>

#include "costs/calibration/bundle_adjustment.h"
#include "costs/calibration/calibration_state.h"
#include "costs/calibration/calibration_views.h"

namespace rgbd_pose {

// What the first half of a recording and the second one say of the same
// parameter, each by itself.
struct HalvesOfParameter {
  int part = 0;         // which, see CalibrationIndex
  double first = 0.0;   // of the first half
  double second = 0.0;  // of the second one
  double sigma = 0.0;   // of their difference

  // How far apart they are, in standard deviations.
  double Sigmas() const;
};

// How far halves are apart in all, as a root mean square in standard
// deviations: about 1 if error bars are right; 0: they were not compared.
double SpreadOfHalves(const std::vector<HalvesOfParameter>& halves);

// Calibrates both halves of a recording (in time) by themselves, from where all
// of it ended. What is wrong with a camera is wrong in both; what is absorbed
// of something else depends on what is seen. Empty if a half has too few views
// or does not tell.
std::vector<HalvesOfParameter> SplitHalfConsistency(
    const CalibrationViews& views, const CalibrationState& found,
    const std::array<bool, kCalibrationSize>& is_free,
    const CalibrationPrior& prior);

}  // namespace rgbd_pose
