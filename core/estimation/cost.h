#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/types.h>

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// How matches become residual blocks. All three describe the same problem:
// equal cost, gradient and J^T J (tests/costs/assembly_test.cc).
enum class Assembly {
  kPerMatch,    // one analytic cost function and one loss a match: textbook
  kAutodiff,    // the same with automatic differentiation: the oracle
  kCompressed,  // one block of 7 rows for all matches: fast, the default
};

// Who has to own the residual blocks of an assembly: the compressed block is
// part of its cost and used again, the others are made for a problem.
constexpr ceres::Ownership BlockOwnership(Assembly assembly) {
  return assembly == Assembly::kCompressed ? ceres::DO_NOT_TAKE_OWNERSHIP
                                           : ceres::TAKE_OWNERSHIP;
}

// A robustified sum over matches, linearised at one motion:
// cost(x + d) ~ cost + gradient . d + 1/2 d^T hessian d (Gauss-Newton).
struct NormalEquations {
  MotionMatrix hessian = MotionMatrix::Zero();   // sum rho' J^T J
  MotionVector gradient = MotionVector::Zero();  // sum rho' J^T r
  double cost = 0.0;                             // 1/2 sum rho
};

// What is known of a motion before its matches are seen. Nothing, if the
// covariance is not positive definite: that of a failed estimate is zero.
struct MotionPrior {
  Rigid3d cur_from_prev;                               // the prediction
  MotionMatrix covariance = MotionMatrix::Identity();  // as MotionEstimate's
};

// What a cost is bound to for one estimation.
struct CostInput {
  const Correspondences& matches;  // of which it takes what it can use
  Rigid3d cur_from_prev;  // where weights that depend on the motion are frozen
  const MotionPrior* prior = nullptr;  // null: nothing is known
  int threads = 1;  // for sums over many matches; results do not depend on it
};

// All that the estimator sees of a cost: whitened residuals over matches. One
// object is one cost bound to one set of matches at a time.
class Cost {
 public:
  virtual ~Cost() = default;

  // As programs take it.
  virtual std::string_view name() const = 0;

  // The number of residuals of a match.
  virtual int rows() const = 0;

  // The number of independent measurements a match brings. Whitened residuals
  // of right matches have a squared norm of about chi^2 of so many degrees.
  virtual int independent_rows() const = 0;

  // Whether weights, or the choice of matches, are frozen at the motion bound
  // to, so that a solver has to bind again when the motion has changed.
  virtual bool freezes_weights() const = 0;

  // Whether the whitened residuals of right matches are independent, of unit
  // variance, so that the Hessian tells the covariance; if not (a formulation
  // that knows no directions, say) their scatter has to be measured.
  virtual bool is_whitened() const = 0;

  // Below which 99 % of the squared norms of right matches lie, for the k-th
  // bound match. Asked of costs that are not whitened only: of others it is a
  // quantile of chi^2.
  virtual double InlierLimit(int k) const = 0;

  // Takes in the matches this cost can use. Keeps nothing of earlier ones but
  // memory.
  virtual void Bind(const CostInput& input) = 0;

  // The places of the bound matches within the Correspondences, increasing; -1
  // for a residual that belongs to no match (a prior).
  virtual const std::vector<int>& matches() const = 0;

  // The number of independent measurements that each bound match brought:
  // independent_rows(), or fewer where it lacks some; rows of those are zero.
  virtual const std::vector<int>& degrees() const = 0;

  // Whitened residuals, rows() for each bound match.
  virtual void Residuals(const MotionDerivatives& motion,
                         std::vector<double>* residuals) const = 0;

  // Squared norm of each bound match's whitened residual, in their order.
  virtual void SquaredNorms(const MotionDerivatives& motion,
                            std::vector<double>* squared_norms) const = 0;

  // Adds this cost's share of the normal equations under a loss (null: none),
  // weighted as Ceres' corrector does where rho'' <= 0: by rho'.
  virtual void Linearise(const MotionDerivatives& motion,
                         const ceres::LossFunction* loss,
                         NormalEquations* sum) const = 0;

  // Adds sum rho'^2 J^T r r^T J over matches: with the Hessian, the covariance
  // of an M-estimate whatever the residuals' true distribution (sandwich).
  virtual void AddScatter(const MotionDerivatives& motion,
                          const ceres::LossFunction* loss,
                          MotionMatrix* scatter) const = 0;

  // Adds the bound matches to a problem in the parameters x[6] that count from
  // `origin`. The problem must own its cost functions as BlockOwnership says
  // and no losses; origin, loss and this cost must outlive it, unchanged.
  virtual void AddTo(Assembly assembly, const MotionOrigin& origin,
                     ceres::LossFunction* loss, double* x,
                     ceres::Problem* problem) = 0;
};

}  // namespace rgbd_pose
