#pragma once

#include <vector>

#include "core/estimation/camera_mounting.h"
#include "core/estimation/robust_problem.h"

namespace rgbd_pose {

// Turns costs of the motion of a camera into costs of the motion of the body
// that carries it, for Estimator::Estimate with the pairs of several cameras. A
// prior is then one of the motion of this camera; for a prior of the body's
// motion add a pair that has only the prior, with the identity as its mounting.
// In Ceres' problem such a cost is one block, whatever the Assembly. Throws
// InputError for a null cost, a negative index or a mounting that is not
// finite.
std::vector<RobustCost> MountCosts(std::vector<RobustCost> costs,
                                   const CameraMounting& mounting);

}  // namespace rgbd_pose
