#pragma once

#include <vector>

#include "core/estimation/camera_mounting.h"
#include "core/estimation/robust_problem.h"

namespace rgbd_pose {

// Makes these costs, bound to the pair of one of several cameras, those of the
// motion of the body that carries them, for Estimator::Estimate with several
// pairs. In Ceres' problem such a cost is one block, whatever the Assembly.
// Throws InputError for a null cost, a negative index or a mounting that is not
// finite.
std::vector<RobustCost> MountCosts(std::vector<RobustCost> costs,
                                   const CameraMounting& mounting);

}  // namespace rgbd_pose
