#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/estimation/motion_estimate.h"

namespace rgbd_pose {

// An estimate whose lists have one entry for each input row, whether the row
// was accepted as a match or not.
struct EstimateResult : MotionEstimate {
  std::vector<uint8_t> inliers;  // is_inlier; an array needs bytes
  size_t num_rejected = 0;
};

}  // namespace rgbd_pose
