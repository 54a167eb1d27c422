#pragma once

#include <vector>

#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_covariance.h"
#include "core/estimation/robust_problem.h"

namespace rgbd_pose {

// What each term of a sum says of the motion it was minimised at: which matches
// agree, and its share of the covariance. Keeps its memory between calls, which
// are made in the order below.
class CovarianceAccumulator {
 public:
  // Fills weights, inliers and residual norms of the estimate, whose lists are
  // as long as the matches, by the norms that the terms have.
  void JudgeMatches(const RobustProblem& terms, MotionEstimate* estimate);

  // RobustProblem::Linearise, less what noise feigns
  // (MotionCost::AddSpuriousInformation).
  NormalEquations Linearise(const RobustProblem& terms,
                            const MotionDerivatives& motion);

  // `inverse` is that of the whole Hessian.
  MotionMatrix Covariance(const RobustProblem& terms,
                          const MotionDerivatives& motion,
                          const MotionMatrix& inverse);

 private:
  std::vector<CovarianceTerm> shares_;
  std::vector<bool> counted_;  // matches
};

}  // namespace rgbd_pose
