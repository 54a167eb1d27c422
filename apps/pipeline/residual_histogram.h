#pragma once

#include <array>
#include <cstdint>

#include "core/estimation/motion_estimate.h"

namespace rgbd_pose {

// How the whitened residuals and the robust weights of a run's matches are
// spread, over all frames.
struct ResidualHistogram {
  // Bins of norms (sigmas) and of weights; the last bin of weights holds 1.
  static constexpr double kNormBin = 0.1;
  static constexpr double kWeightBin = 0.05;

  int64_t matches = 0;  // that some cost could use
  std::array<int64_t, 80> norms = {};
  int64_t norms_above = 0;  // the last bin
  std::array<int64_t, 20> weights = {};
  int64_t weights_zero = 0;             // exactly
  std::array<int64_t, 7> degrees = {};  // matches of 0 to 6 measurements

  // Adds the matches of one frame.
  void Add(const MotionEstimate& estimate);
};

}  // namespace rgbd_pose
