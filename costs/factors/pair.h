#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/estimation/motion_cost.h"
#include "core/estimation/robust_problem.h"
#include "core/factors/blocks.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Where the cameras of a pair are mounted on the bodies whose poses are
// estimated, and which blocks follow the two poses.
struct PairMounting {
  // How many mountings are estimated.
  enum Blocks {
    kNone,    // the mountings are constant: those below
    kShared,  // one, body_from_cam of both frames
    kEach,    // two, body_from_cam of `ref` and of `cur`
  };
  Blocks blocks = kNone;      // which of them follow the poses
  Rigid3d body_from_ref_cam;  // where the camera of `ref` is mounted
  Rigid3d body_from_cur_cam;  // where that of `cur` is
};

// A cost over two frames (all matches, all pixels, a prior) under its loss, as
// one block of 7 rows over the poses of both bodies, and over mountings: the
// cost, the gradient and the Hessian of Gauss-Newton are those of one block per
// residual, so a solver takes the same steps (docs/compressed_block.md).
//
// Add it without a loss: it is inside. Nothing is kept between evaluations, so
// the loss may change between solves (ceres::LossFunctionWrapper). An object
// serves one thread at a time; a solver with many threads obeys that.
class PairFactor final : public ceres::CostFunction {
 public:
  // Binds the cost to the frames (`ref` is FramePair::prev) and chooses its
  // residuals at a guess of their motion. Images must outlive this object.
  PairFactor(RobustCost cost, const FramePair& pair,
             const Rigid3d& cur_from_ref, const PairMounting& mounting = {});

  // Chooses residuals and weights again, at the motion that a solve has found;
  // of use for costs with another MotionCost::association than kOnce.
  void Associate(const Rigid3d& cur_from_ref);

  // The cost as bound to the frames.
  const MotionCost& cost() const { return *cost_.cost; }

  // Fills in 7 residuals, whose squares add up to twice the cost.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  bool EvaluateCost(const MotionDerivatives& motion, double* residuals) const;

  const RobustCost cost_;
  const ScaledLoss loss_;
  const PairMounting::Blocks mounting_blocks_;
  const PoseOf<double> ref_mounting_, cur_mounting_;
  mutable std::vector<double> norms_;
};

}  // namespace rgbd_pose
