#pragma once

#include "core/estimation/robust_problem.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// What wrong matches that agree with the motion by chance add to its covariance
// of [omega (rad), C (m)].
//
// A match of a long lever draws the motion to itself: of its error, only the
// share 1 - h is seen as its residual (h: its leverage, its own share of what
// all blocks know along its direction). It agrees up to an error of
// limit / (1 - h), which moves the motion. Where that is more than five sigmas
// of `covariance`, the sum has the square of this movement times the odds that
// such a match is wrong,
//
//   (disagreeing / agreeing) / (1 - h) R^-rows,
//
// as residuals of wrong matches extend to R limits (see FalseAlarms), and must
// be within 1 / (1 - h) limits along one direction, and within one along the
// others. Nothing is added if all matches agree, for blocks of three or more
// rows, which hardly ever agree by chance, or for more than a hundred blocks,
// of which none has such a lever. `inverse` is that of the Hessian.
MotionMatrix HiddenErrors(const RobustProblem& problem,
                          const Rigid3d& cur_from_prev,
                          const MotionMatrix& inverse,
                          const MotionMatrix& covariance);

}  // namespace rgbd_pose
