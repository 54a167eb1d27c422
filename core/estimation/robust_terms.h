#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "core/estimation/cost.h"
#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_covariance.h"
#include "core/estimation/scaled_loss.h"

namespace rgbd_pose {

// A cost and the loss on each of its residual blocks.
struct RobustCost {
  std::unique_ptr<Cost> cost;                 // must not be null
  std::unique_ptr<ceres::LossFunction> loss;  // null: least squares
};

// The sum that an estimator minimises: costs under their losses, bound to the
// matches of one estimation at a time, with the memory they share.
class RobustTerms {
 public:
  explicit RobustTerms(std::vector<RobustCost> costs);

  bool has_losses() const;

  // Binds all costs; with their losses at their nominal widths.
  void Bind(const CostInput& input);

  // Binds the costs again that freeze weights, where the matches used may
  // change with the motion too. False if no cost freezes any.
  bool BindAgain(const CostInput& input);

  // Matches that some cost uses, and residual blocks of all costs.
  int num_used() const { return num_used_; }
  int num_blocks() const { return num_blocks_; }

  // Widens all losses by a factor on their nominal widths.
  void SetLosses(double scale);

  void AddTo(Assembly assembly, const MotionOrigin& origin, double* x,
             ceres::Problem* problem);

  NormalEquations Linearise(const MotionDerivatives& motion) const;
  NormalEquations LineariseWithoutLosses(const MotionDerivatives& motion) const;

  // Squared norms of all blocks; returns their robust spread in units of the
  // noise model, which is 1 for right matches.
  double UpdateNorms(const MotionDerivatives& motion);

  // The spread of residual components by a scale estimator.
  double EstimateScale(const MotionDerivatives& motion,
                       double (*scale)(std::vector<double>* residuals));

  // Fills weights, inliers and residual norms of the estimate, for residuals of
  // `scale` times the nominal spread; sums up what the covariance needs.
  LossSums JudgeMatches(double scale, MotionEstimate* estimate);

  // Covariance of the estimate, `inverse` being that of the Hessian.
  MotionMatrix Covariance(const MotionDerivatives& motion, const LossSums& sums,
                          const MotionMatrix& inverse);

 private:
  void CountMatches(size_t num_matches);
  void JudgeMatch(int match, double weight, bool agrees,
                  MotionEstimate* estimate);

  // The loss of a term at its present width; null for least squares.
  const ceres::LossFunction* Loss(size_t term) const {
    return costs_[term].loss ? &losses_[term] : nullptr;
  }

  const std::vector<RobustCost> costs_;
  std::vector<ScaledLoss> losses_;
  std::vector<std::vector<double>> norms_;  // squared, of each cost's blocks
  int num_used_ = 0;
  int num_blocks_ = 0;

  // Memory that is used again.
  std::vector<WeightedCost> weighted_;
  std::vector<double> values_;
  std::vector<double> residuals_;
  std::vector<bool> counted_;
};

}  // namespace rgbd_pose
