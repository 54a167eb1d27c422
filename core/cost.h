#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "core/correspondences.h"
#include "core/motion.h"

namespace rgbd_pose {

// How matches become residual blocks. All three describe the same problem:
// equal cost, gradient and J^T J (tests/assembly_test.cc).
enum class Assembly {
  kPerMatch,    // one analytic cost function and one loss a match: textbook
  kAutodiff,    // the same with automatic differentiation: the oracle
  kCompressed,  // one block of 7 rows for all matches: fast, the default
};

// A robustified sum over matches, linearised at one motion:
// cost(x + d) ~ cost + gradient . d + 1/2 d^T hessian d (Gauss-Newton).
struct NormalEquations {
  MotionMatrix hessian = MotionMatrix::Zero();
  MotionVector gradient = MotionVector::Zero();
  double cost = 0.0;
};

// All that the estimator sees of a cost: whitened residuals over matches. One
// object is one cost bound to one set of matches at a time.
class Cost {
 public:
  virtual ~Cost() = default;

  virtual std::string_view name() const = 0;

  // The number of independent measurements a match brings. Whitened residuals
  // of right matches have a squared norm of about chi^2 of so many degrees.
  virtual int independent_rows() const = 0;

  // Takes in the matches this cost can use. Weights that depend on the motion
  // are frozen at `cur_from_prev`. Keeps nothing of earlier matches but memory.
  virtual void Bind(const Correspondences& correspondences,
                    const Rigid3d& cur_from_prev) = 0;

  // The places of the bound matches within the Correspondences, increasing.
  virtual const std::vector<int>& matches() const = 0;

  // Squared norm of each bound match's whitened residual, in their order.
  virtual void SquaredNorms(const MotionDerivatives& motion,
                            std::vector<double>* squared_norms) const = 0;

  // Adds this cost's share of the normal equations under a loss (null: none),
  // weighted as Ceres' corrector does where rho'' <= 0: by rho'.
  virtual void Linearise(const MotionDerivatives& motion,
                         const ceres::LossFunction* loss,
                         NormalEquations* sum) const = 0;

  // Adds the bound matches to a problem in the parameters x[6] that count from
  // `origin`. Losses stay owned by the caller; origin, loss and this cost must
  // outlive the problem.
  virtual void AddTo(Assembly assembly, const MotionOrigin& origin,
                     ceres::LossFunction* loss, double* x,
                     ceres::Problem* problem) const = 0;
};

}  // namespace rgbd_pose
