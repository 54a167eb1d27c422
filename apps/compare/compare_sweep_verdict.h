#pragma once

#include <string>
#include <vector>

#include "apps/compare/compare_sweep.h"

namespace rgbd_pose {

// What a sweep says, in words and its own figures: which M-estimator, by how
// much, with what spread, and what a start from RANSAC changes.
std::string SweepVerdict(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
