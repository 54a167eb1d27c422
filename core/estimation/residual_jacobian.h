#pragma once

#include <Eigen/Core>

#include "core/estimation/motion_cost.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Derivatives of residuals by [omega C], a row for each residual.
using ResidualJacobian = Eigen::Matrix<double, Eigen::Dynamic, 6>;

// Of all residuals of a bound cost, block by block. By differences, as costs
// give no derivatives of single blocks: exact enough to judge an estimate.
ResidualJacobian DifferenceJacobian(const MotionCost& cost,
                                    const Rigid3d& cur_from_prev);

}  // namespace rgbd_pose
