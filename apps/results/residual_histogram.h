#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/estimation/motion_estimate.h"

namespace rgbd_pose {

// How the whitened residuals and the robust weights of a run's matches are
// spread, over all frames.
class ResidualHistogram {
 public:
  // Bins of norms (sigmas) and of weights; the last bin of weights holds 1.
  static constexpr double kNormBin = 0.1;
  static constexpr double kWeightBin = 0.05;

  // Adds the matches of one frame that some cost could use.
  void Add(const MotionEstimate& estimate);

  // For metrics.json: widths of bins, counts, how many norms lie above the
  // bins, how many weights are exactly 0, and how many matches hold 0, 1, ...,
  // 6 independent measurements.
  nlohmann::json ToJson() const;

 private:
  int64_t matches_ = 0;
  std::array<int64_t, 80> norms_ = {};
  int64_t norms_above_ = 0;
  std::array<int64_t, 20> weights_ = {};
  int64_t weights_zero_ = 0;
  std::array<int64_t, 7> degrees_ = {};
};

}  // namespace rgbd_pose
