#pragma once

#include <vector>

#include "core/factors/check_factor.h"
#include "core/factors/sampler.h"

namespace rgbd_pose {

// A factor that depends on no cost.
struct ListedFactor {
  const char* name;  // its kName
  // Returns it with random measurements, for a check of its Jacobian.
  CheckableFactor (*sample)(FactorSampler* random);
};

// All of them. A new one needs its header, an entry in factor_list.cc and a row
// in docs/factors.md; its Jacobian test and its lines in rgbd_jacobians follow
// from this list.
const std::vector<ListedFactor>& ListedFactors();

}  // namespace rgbd_pose
