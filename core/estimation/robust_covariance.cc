#include "core/estimation/robust_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace rgbd_pose {
namespace {

// With fewer blocks their scatter is too uncertain to take for a covariance.
constexpr int kMinBlocksForScatter = 30;

// The slope can vanish for redescending losses among many outliers; a fifth of
// the weight keeps the covariance finite and pessimistic.
constexpr double kMinSlope = 0.2;

}  // namespace

MotionMatrix RobustCovariance(const std::vector<CovarianceTerm>& terms,
                              const MotionMatrix& inverse) {
  MotionMatrix A = MotionMatrix::Zero(), B = MotionMatrix::Zero();
  MotionMatrix measured = MotionMatrix::Zero(), exact = MotionMatrix::Zero();
  double weight_p = 0.0;
  for (const CovarianceTerm& term : terms) {
    if (term.scale_group == MotionCost::kFixedScale) {
      exact += term.hessian;
      continue;
    }
    LossSums sums;
    for (const CovarianceTerm& other : terms) {
      if (other.scale_group == term.scale_group) sums += other.sums;
    }
    if (!(sums.weight_p > 0.0)) continue;
    const bool by_hessian = term.is_whitened ||
                            sums.blocks < kMinBlocksForScatter ||
                            sums.psi2 < sums.least_psi2;
    const double psi2 = std::max(sums.psi2, sums.least_psi2);
    B += by_hessian ? MotionMatrix(psi2 / sums.weight_p * term.hessian)
                    : term.scatter;
    A += std::max(sums.slope_p / sums.weight_p, kMinSlope) * term.hessian;
    measured += term.hessian;
    weight_p += term.sums.weight_p;
  }
  // Six less what a prior determines.
  const double parameters = (inverse * measured).trace();
  const double fitted =
      weight_p > 2.0 * parameters ? weight_p / (weight_p - parameters) : 2.0;
  const MotionMatrix A_inverse =
      (A + exact).llt().solve(MotionMatrix::Identity());
  return A_inverse * (fitted * B + exact) * A_inverse;
}

}  // namespace rgbd_pose
