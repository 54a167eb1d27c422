#pragma once

#include <vector>

#include "core/estimation/motion_cost.h"
#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_problem.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// What the covariance of an M-estimate needs of the losses: sums over residual
// blocks of s = |r|^2 (r whitened, by the estimated scale too), p independent
// rows and the loss' rho' and rho'' at s.
struct LossSums {
  double psi2 = 0.0;      // rho'^2 s
  double weight_p = 0.0;  // rho' p
  double slope_p = 0.0;   // rho' p + 2 s rho''
  int blocks = 0;
  double least_psi2 = 0.0;  // psi2 of residuals that are as small as rounding

  LossSums& operator+=(const LossSums& other) {
    psi2 += other.psi2;
    weight_p += other.weight_p;
    slope_p += other.slope_p;
    blocks += other.blocks;
    least_psi2 += other.least_psi2;
    return *this;
  }
};

// A cost's share in the covariance.
struct CovarianceTerm {
  MotionMatrix hessian;  // weighted by rho'
  MotionMatrix scatter;  // sum rho'^2 J^T r r^T J, unless `is_whitened`
  bool is_whitened;
  int scale_group;  // as MotionCost's
  LossSums sums;
};

// Sandwich A^-1 B A^-1 of an M-estimate (Huber, Robust Statistics, 6.3) over
// all costs. A sums up the weighted Hessians, times the mean slope of psi
// against its mean weight; B sums up the same times the mean of psi^2 against
// the mean weight or, for costs that do not whiten fully, the scatter of their
// blocks, with the usual correction for fitted parameters. Means are those of a
// scale group. Residuals that are all but zero (a frame against itself) are no
// proof of a measurement better than what it is rounded to. The Hessian of
// exact sigmas (a prior) is in both as it is. `inverse` is that of the sum of
// all Hessians.
MotionMatrix RobustCovariance(const std::vector<CovarianceTerm>& terms,
                              const MotionMatrix& inverse);

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
