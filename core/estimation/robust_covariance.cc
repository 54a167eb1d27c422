#include "core/estimation/robust_covariance.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// With fewer matches their scatter is too uncertain to take for a covariance.
constexpr int kMinBlocksForScatter = 30;

// The slope can vanish for redescending losses among many outliers; a fifth of
// the weight keeps the covariance finite and pessimistic.
constexpr double kMinSlope = 0.2;

}  // namespace

MotionMatrix RobustCovariance(const std::vector<WeightedCost>& costs,
                              const MotionDerivatives& motion,
                              const LossSums& sums,
                              const MotionMatrix& inverse) {
  NormalEquations whitened;
  MotionMatrix scatter = MotionMatrix::Zero();
  for (const WeightedCost& term : costs) {
    if (term.cost->is_whitened() || sums.blocks < kMinBlocksForScatter) {
      term.cost->Linearise(motion, term.loss, &whitened);
    } else {
      term.cost->AddScatter(motion, term.loss, &scatter);
    }
  }
  scatter += sums.psi2 / sums.weight_p * whitened.hessian;
  const double slope = std::max(sums.slope_p / sums.weight_p, kMinSlope);
  const double fitted =
      sums.weight_p > 12.0 ? sums.weight_p / (sums.weight_p - 6.0) : 2.0;
  return fitted / (slope * slope) * inverse * scatter * inverse;
}

}  // namespace rgbd_pose
