#pragma once

#include <vector>

#include "core/estimation/chance_agreement.h"
#include "core/estimation/motion_cost.h"
#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_problem.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Sums over residual blocks that the covariance of an M-estimate needs: s =
// |r|^2 (r whitened, also by the estimated scale), p independent rows, and rho'
// and rho'' of the loss at s.
struct LossSums {
  double psi2 = 0.0;        // rho'^2 s
  double weight_p = 0.0;    // rho' p
  double slope_p = 0.0;     // rho' p + 2 s rho''
  double blocks = 0.0;      // each counts as its weight
  double model_psi2 = 0.0;  // psi2 of residuals of the noise model's size

  LossSums& operator+=(const LossSums& other) {
    psi2 += other.psi2;
    weight_p += other.weight_p;
    slope_p += other.slope_p;
    blocks += other.blocks;
    model_psi2 += other.model_psi2;
    return *this;
  }
};

// The contribution of a cost to the covariance.
struct CovarianceTerm {
  MotionMatrix hessian;  // weighted by rho'
  MotionMatrix scatter;  // sum rho'^2 J^T r r^T J, unless `is_whitened`
  MotionVector gradient = MotionVector::Zero();
  bool is_whitened;
  int scale_group;  // as in MotionCost
  LossSums sums;
};

// Sandwich A^-1 B A^-1 of an M-estimate (Huber, Robust Statistics, 6.3). A is
// the sum of the weighted Hessians, each times the ratio of the mean slope of
// psi to the mean weight. B is the sum of the same Hessians, each times the
// variance of its rows in units of the noise model,
//
//   (sum of psi^2 + d0) / (sum of weights - fitted + d0),
//
// or, for costs that do not whiten fully, of the scatter of their blocks in
// place of psi^2, times n / (n - 7): a matrix of six parameters from n samples
// is noisy itself, by which chi^2 grows so much (Hotelling, Ann. Math. Stat. 2,
// 1931). Sums are over a scale group; `fitted` is its share of the six
// parameters. The noise model, at its estimated scale, counts as d0 = 6 rows
// (the moderated variance of Smyth, Stat. Appl. Genet. Mol. Biol. 3, 2004): the
// residuals of few matches are small because the motion is fitted to them.
// Residuals that are almost zero (a frame against itself) do not prove a
// measurement to be better than its rounding. The Hessian of exact sigmas (a
// prior) is added to A and B unchanged. `inverse` is the inverse of the sum of
// all Hessians.
MotionMatrix RobustCovariance(const std::vector<CovarianceTerm>& terms,
                              const MotionMatrix& inverse);

// Which matches agree with the motion at the minimum, and each term's part of
// the covariance. Functions must be called in this order. Reuses memory.
class CovarianceAccumulator {
 public:
  // Fills weights, inliers and residual norms, of one entry per match.
  void JudgeMatches(const RobustProblem& problem, MotionEstimate* estimate);

  // FalseAlarms of the matches that agree with the motion, of as many
  // parameters as they determine. 0 if pixels determine it, too, or if priors
  // alone do, within this standard deviation (rad and m). `inverse` is the
  // inverse of the whole Hessian.
  double FalseAlarmsOf(const RobustProblem& problem,
                       const MotionMatrix& inverse,
                       double max_standard_deviation);

  // RobustProblem::Linearise, minus MotionCost::AddSpuriousInformation.
  NormalEquations Linearise(const RobustProblem& problem,
                            const MotionDerivatives& motion);

  // The information of pixels alone on a change of the motion.
  double KnownByPixels(const RobustProblem& problem,
                       const MotionVector& change) const;

  // `inverse` is the inverse of the whole Hessian.
  MotionMatrix Covariance(const RobustProblem& problem,
                          const MotionDerivatives& motion,
                          const MotionMatrix& inverse);

  // Chi^2 of six degrees of freedom of how far residuals beyond the limits of
  // inliers pull the motion away from where the others alone would have it. 0
  // for losses under which large residuals hardly pull, and for pixels.
  double PullOfOutliers(const RobustProblem& problem,
                        const Rigid3d& cur_from_prev,
                        const MotionMatrix& covariance) const;

  // Chi^2 of six degrees of freedom of the difference between what priors say
  // and what everything else says. `covariance` is that of the estimate.
  double PriorChiSquared(const MotionMatrix& covariance) const;

 private:
  std::vector<CovarianceTerm> shares_;
  std::vector<bool> counted_;  // matches
  std::vector<MatchAgreement> agreements_;
};

}  // namespace rgbd_pose
