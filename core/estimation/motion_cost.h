#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/types.h>

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/estimation/frame_view.h"
#include "core/estimation/motion_prior.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/util/chi_squared.h"

namespace rgbd_pose {

// How matches become residual blocks of Ceres. All three describe the same
// problem: equal cost, gradient and J^T J (tests/costs/assembly_test.cc).
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

// What a cost may look at: the two frames of a pair and what is known of the
// motion between them.
struct FramePair {
  const Correspondences* matches = nullptr;  // null: none
  const MotionPrior* prior = nullptr;        // null: nothing is known
  const FrameView* prev = nullptr;           // null: no images
  const FrameView* cur = nullptr;            // likewise
  // From a guess that is near only the finest levels need to be gone through;
  // 0: all that costs have.
  int num_levels = 0;

  int threads = 1;  // for sums over many residuals; results do not depend on it
};

// When the solver has a cost decide again which residuals take part, and with
// which weights, since both may depend on the motion. In order: what asks for
// more comes later.
enum class AssociationPolicy {
  kOnce,       // at the guess
  kWhenMoved,  // when the motion has changed a good deal since
  kEveryStep,  // after every step
};

// All that the estimator sees of a cost: whitened residual blocks over whatever
// two frames share (matches, pixels, surfaces) as a function of the motion
// between them. One object is one cost bound to one pair at a time. Used as
//
//   Bind(pair), [SetLevel(level)], Associate(motion), then everything below.
class MotionCost {
 public:
  // The scale group of a cost whose sigmas are exact (a prior): see
  // scale_group().
  static constexpr int kFixedScale = -1;

  virtual ~MotionCost() = default;

  // As programs take it.
  virtual std::string_view name() const = 0;

  // The number of residuals of a block: of a match, say, or a pixel.
  virtual int num_residuals() const = 0;

  // The number of independent measurements a block brings. Whitened residuals
  // of right matches have a squared norm of about chi^2 of so many degrees.
  virtual int degrees_of_freedom() const = 0;

  // Whether the whitened residuals of right matches are independent, of unit
  // variance, so that the Hessian gives the covariance; if not (a formulation
  // that knows no directions, say) their scatter has to be measured.
  virtual bool is_whitened() const = 0;

  // Below which 99 % of the squared norms of right matches lie, for the k-th
  // block. Asked of costs that are not whitened only: of others it is this
  // quantile of chi^2.
  virtual double InlierLimit(int k) const { return ChiSquared99(degrees()[k]); }

  // Costs of one group share the scale by which their sigmas are off, which is
  // estimated (EstimatorOptions::scale) or measured by the scatter of their
  // residuals: gray levels and metres have scales of their own. kFixedScale:
  // the sigmas hold, and the cost takes no part in either.
  virtual int scale_group() const { return 0; }

  // The share of its information that a cost's blocks bring: below 1 where they
  // are not independent of each other (neighbouring pixels, say). Multiplies
  // the cost, and so the inverse of the covariance.
  virtual double information_factor() const { return 1.0; }

  // When Associate is to be called.
  virtual AssociationPolicy association() const = 0;

  // Coarse to fine: how many levels there are, and the one that is in force
  // from the next Associate on; 0, the finest, after Bind.
  virtual int num_levels() const { return 1; }
  virtual void SetLevel(int /*level*/) {}

  // Takes a pair in; keeps nothing of an earlier one but memory. Matches and
  // prior need to stay for this call alone, images for as long as it is bound.
  virtual void Bind(const FramePair& pair) = 0;

  // Decides which residuals take part, and freezes their weights, at a motion.
  virtual void Associate(const Rigid3d& cur_from_prev) = 0;

  // The same within a solve, for costs that are associated at every step: what
  // has to be one number for a whole solve (a change of brightness, say) stays.
  virtual void Reassociate(const Rigid3d& cur_from_prev) {
    Associate(cur_from_prev);
  }

  // For each block its match's place within the Correspondences, increasing; -1
  // for a block that belongs to no match (a pixel, a prior).
  virtual const std::vector<int>& matches() const = 0;

  // The number of independent measurements that each block brought:
  // degrees_of_freedom(), or fewer where it lacks some; rows of those are zero.
  virtual const std::vector<int>& degrees() const = 0;

  // Whitened residuals, num_residuals() for each block.
  virtual void Residuals(const MotionDerivatives& motion,
                         std::vector<double>* residuals) const = 0;

  // Squared norm of each block's whitened residual.
  virtual void SquaredNorms(const MotionDerivatives& motion,
                            std::vector<double>* squared_norms) const = 0;

  // Adds this cost's share of the normal equations under a loss (null: none),
  // weighted as Ceres' corrector does where rho'' <= 0: by rho'.
  virtual void Linearise(const MotionDerivatives& motion,
                         const ceres::LossFunction* loss,
                         NormalEquations* sum) const = 0;

  // Adds sum rho'^2 J^T r r^T J over blocks: with the Hessian, the covariance
  // of an M-estimate whatever the residuals' true distribution (sandwich).
  virtual void AddScoreOuterProduct(const MotionDerivatives& motion,
                                    const ceres::LossFunction* loss,
                                    MotionMatrix* scatter) const = 0;

  // Adds what noise of the derivatives themselves (of an image, of a surface's
  // slope) feigns to tell: the Hessian of rows that are nothing but this noise,
  // in units of the estimated scale. Exact derivatives have none.
  virtual void AddSpuriousInformation(const MotionDerivatives& /*motion*/,
                                      MotionMatrix* /*hessian*/) const {}

  // Adds the blocks to a problem in the parameters x[6] that count from
  // `origin`. The problem must own its cost functions as BlockOwnership says
  // and no losses; origin, loss and this cost must outlive it, unchanged.
  virtual void AddTo(Assembly assembly, const LinearizationPoint& origin,
                     ceres::LossFunction* loss, double* x,
                     ceres::Problem* problem) = 0;
};

}  // namespace rgbd_pose
