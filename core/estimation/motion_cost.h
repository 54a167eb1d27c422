#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/types.h>

#include <string_view>
#include <vector>

#include "core/estimation/camera_mounting.h"
#include "core/estimation/correspondences.h"
#include "core/estimation/frame_view.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/util/quantile.h"

namespace rgbd_pose {

// How matches become residual blocks of Ceres. All three describe the same
// problem: equal cost, gradient and J^T J (tests/costs/assembly_test.cc).
enum class Assembly {
  kPerMatch,    // one analytic cost function and loss per match: textbook
  kAutodiff,    // the same with automatic differentiation: for checks
  kCompressed,  // one block of 7 rows for all matches: fast, the default
};

// The compressed block is part of its cost and reused; the residual blocks of
// other assemblies are created for each problem.
constexpr ceres::Ownership BlockOwnership(Assembly assembly) {
  return assembly == Assembly::kCompressed ? ceres::DO_NOT_TAKE_OWNERSHIP
                                           : ceres::TAKE_OWNERSHIP;
}

// What a residual type over matches packs its columns from.
struct CostInput {
  const Correspondences& matches;      // with the observations
  Rigid3d cur_from_prev;               // weights are frozen at this motion
  const MotionPrior* prior = nullptr;  // null: nothing is known
};

// A robustified sum over matches, linearised at one motion:
// cost(x + d) ~ cost + gradient . d + 1/2 d^T hessian d (Gauss-Newton).
struct NormalEquations {
  MotionMatrix hessian = MotionMatrix::Zero();   // sum rho' J^T J
  MotionVector gradient = MotionVector::Zero();  // sum rho' J^T r
  double cost = 0.0;                             // 1/2 sum rho
};

// The data a cost may use: two frames and prior knowledge of their motion.
struct FramePair {
  const Correspondences* matches = nullptr;  // null: none
  const MotionPrior* prior = nullptr;        // null: no prior
  const FrameView* prev = nullptr;           // null: no images
  const FrameView* cur = nullptr;            // null: no images
  int num_levels = 0;  // of the finest levels, for a good guess; 0: all
  int threads = 1;  // for sums over many residuals; results do not depend on it
};

// When a cost chooses its residuals and their weights again; rarest first.
enum class AssociationPolicy {
  kOnce,       // at the guess
  kWhenMoved,  // when the motion has changed considerably since then
  kEveryStep,  // after every step
};

// The interface of a cost to the estimator: whitened residual blocks over any
// data that two frames share (matches, pixels, surfaces) as a function of the
// motion between them. One object is one cost bound to one pair at a time. Call
// order:
//
//   Bind(pair), [SetLevel(level)], Associate(motion), then everything below.
class MotionCost {
 public:
  // The scale group of a cost with exact sigmas (a prior): see scale_group().
  static constexpr int kFixedScale = -1;

  virtual ~MotionCost() = default;

  // As given to programs.
  virtual std::string_view name() const = 0;

  // The number of residuals of a block, e.g. of a match or a pixel.
  virtual int num_residuals() const = 0;

  // The number of independent measurements per block: the degrees of freedom of
  // the chi^2 that the squared norm of an inlier approximately follows.
  virtual int degrees_of_freedom() const = 0;

  // Whether the residuals of inliers are independent with unit variance, so the
  // Hessian gives the covariance. Otherwise their scatter is measured.
  virtual bool is_whitened() const = 0;

  // 99 % of the squared norms of inliers of the k-th block are below this.
  virtual double InlierLimit(int k) const { return ChiSquared99(degrees()[k]); }

  // Costs of one group share the factor by which their sigmas are wrong, which
  // is estimated (EstimatorOptions::scale) or measured by their scatter. Gray
  // levels and metres differ. kFixedScale: the sigmas are exact.
  virtual int scale_group() const { return 0; }

  // The share of independent information in the blocks: below 1 if they depend
  // on each other (e.g. neighbouring pixels). Multiplies the cost.
  virtual double information_factor() const { return 1.0; }

  // Where the camera of the pair is on the body whose motion is estimated. All
  // motions below are those of the body (see costs/mounted_costs.h).
  virtual CameraMounting mounting() const { return {}; }

  // When Associate has to be called.
  virtual AssociationPolicy association() const = 0;

  // Coarse to fine: the number of levels, and the level to use from the next
  // Associate on. After Bind it is 0, the finest.
  virtual int num_levels() const { return 1; }
  virtual void SetLevel(int /*level*/) {}

  // Keeps only memory from an earlier pair. Matches and prior must exist during
  // this call, images while the cost is bound.
  virtual void Bind(const FramePair& pair) = 0;

  // Chooses the residuals and freezes their weights at a motion.
  virtual void Associate(const Rigid3d& cur_from_prev) = 0;

  // The same within a solve, for costs that are associated at every step: keeps
  // values that must be constant in a solve (e.g. a brightness change).
  virtual void Reassociate(const Rigid3d& cur_from_prev) {
    Associate(cur_from_prev);
  }

  // The index of each block's match, increasing; -1 for a pixel or a prior.
  virtual const std::vector<int>& matches() const = 0;

  // degrees_of_freedom() of each block, less missing measurements (zero rows).
  virtual const std::vector<int>& degrees() const = 0;

  // Whitened residuals, num_residuals() for each block.
  virtual void Residuals(const MotionDerivatives& motion,
                         std::vector<double>* residuals) const = 0;

  // Squared norm of the whitened residual of each block.
  virtual void SquaredNorms(const MotionDerivatives& motion,
                            std::vector<double>* squared_norms) const = 0;

  // Adds the contribution of this cost to the normal equations under a loss
  // (null: none), weighted by rho', as Ceres' corrector does if rho'' <= 0.
  virtual void Linearise(const MotionDerivatives& motion,
                         const ceres::LossFunction* loss,
                         NormalEquations* sum) const = 0;

  // Adds sum rho'^2 J^T r r^T J over blocks: with the Hessian, it gives the
  // (sandwich) covariance for any true distribution of residuals.
  virtual void AddScoreOuterProduct(const MotionDerivatives& motion,
                                    const ceres::LossFunction* loss,
                                    MotionMatrix* scatter) const = 0;

  // Adds the Hessian of pure noise of the derivatives (of an image, of a slope)
  // in units of the estimated scale. Exact derivatives have none.
  virtual void AddSpuriousInformation(const MotionDerivatives& /*motion*/,
                                      MotionMatrix* /*hessian*/) const {}

  // Adds the blocks to a problem in the parameters x[6] relative to `origin`.
  // The problem must own its cost functions according to BlockOwnership, and no
  // losses. Origin, loss and this cost must outlive it, unchanged.
  virtual void AddTo(Assembly assembly, const LinearizationPoint& origin,
                     ceres::LossFunction* loss, double* x,
                     ceres::Problem* problem) = 0;
};

}  // namespace rgbd_pose
