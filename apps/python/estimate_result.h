#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/estimation/motion_estimate.h"

namespace rgbd_pose {

// An estimate whose lists hold one entry for each row that was given, accepted
// as a match or not.
struct EstimateResult {
  MotionEstimate estimate;
  std::vector<uint8_t> is_inlier;
  size_t num_rejected = 0;
};

}  // namespace rgbd_pose
