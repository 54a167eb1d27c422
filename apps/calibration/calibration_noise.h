#pragma once

#include <optional>
#include <vector>

#include "core/geometry/depth_noise.h"
#include "costs/calibration/bundle_adjustment.h"

namespace rgbd_pose {

// How much depths of about one size scatter.
struct DepthScatter {
  double depth = 0.0;  // m
  double sigma = 0.0;  // m, of single pixels
};

// What a recording says of the noise of its depths.
struct DepthNoiseFit {
  DepthNoiseModel model;         // sigma(z) = constant + quadratic z^2
  double constant_sigma = 0.0;   // their standard deviations; 0: taken as 0
  double quadratic_sigma = 0.0;  // since it is not separable from that
  std::vector<DepthScatter> scatter;  // what it was fitted to
  int samples = 0;                    // depths

  // How much depths scatter, in the sigmas of the model that was there.
  double in_old_sigmas = 0.0;
};

// Fits the noise of single pixels' depths to how they scatter about landmarks
// that are seen in several keyframes, robustly. Errors of where a feature is
// seen do not count: depths are compared where the landmark is. `old`: the
// model that was there. Nothing if there are too few.
std::optional<DepthNoiseFit> FitDepthNoise(const CalibrationViews& views,
                                           const CalibrationState& state,
                                           const DepthNoiseModel& old);

}  // namespace rgbd_pose
