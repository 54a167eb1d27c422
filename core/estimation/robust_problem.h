#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/estimation/motion_cost.h"

namespace rgbd_pose {

// A cost and the loss on each of its residual blocks.
struct RobustCost {
  std::unique_ptr<MotionCost> cost;           // must not be null
  std::unique_ptr<ceres::LossFunction> loss;  // null: least squares
};

// One term of a sum, bound to a pair.
struct RobustTerm {
  const MotionCost& cost;  // as it was given
  const ScaledLoss& loss;  // at its present width
  bool has_loss;           // otherwise least squares as it is
  bool has_scale;          // its sigmas are as uncertain as the matches' noise
  double scale;            // see RobustProblem::UpdateScales
  double factor;           // its weight in the sum, apart from its loss
  const std::vector<double>& norms;  // squared, of its blocks

  // As MotionCost takes it.
  const ceres::LossFunction* loss_or_null() const {
    return has_loss ? &loss : nullptr;
  }
};

// The sum that an estimator minimises: costs under their losses, bound to one
// pair at a time, with the memory they share.
class RobustProblem {
 public:
  explicit RobustProblem(std::vector<RobustCost> costs);

  bool has_losses() const;

  // The number of levels of the cost that has most.
  int num_levels() const;

  // Binds all costs at the finest level, with their losses at their nominal
  // widths, and associates them.
  void Bind(const FramePair& pair, const Rigid3d& cur_from_prev);

  // Costs with fewer levels stay at their coarsest as long.
  void SetLevel(int level, const Rigid3d& cur_from_prev);

  // Whether a cost asks to be associated at least as often as `least`.
  bool AsksFor(AssociationPolicy least) const;

  // Associates the costs again that do. False if there are none.
  bool Associate(AssociationPolicy least, const Rigid3d& cur_from_prev);

  // MotionCost::Reassociate of the costs that are associated at every step.
  void Reassociate(const Rigid3d& cur_from_prev);

  // Matches that some cost uses and blocks that need none; a prior is neither.
  int num_used() const { return num_used_; }

  // Widens all losses by a factor on their widths at the scales in force.
  void SetLosses(double width);

  void AddTo(Assembly assembly, const LinearizationPoint& origin, double* x,
             ceres::Problem* problem);

  NormalEquations Linearise(const MotionDerivatives& motion,
                            bool with_losses = true) const;

  // Squared norms of all blocks; returns their robust spread in units of the
  // noise model at the scales in force, which is 1 for right matches.
  double UpdateNorms(const MotionDerivatives& motion);

  // By how much the noise of each group of costs exceeds its model: 1, or as a
  // scale estimator finds it in the residuals' components. False if that is no
  // news: nothing has changed then.
  void ResetScales() { scales_.assign(costs_.size(), 1.0); }
  bool UpdateScales(const MotionDerivatives& motion,
                    double (*scale)(std::vector<double>* residuals));

  // The largest of these.
  double scale() const;

  // One of them, as it stands now.
  size_t size() const { return costs_.size(); }
  RobustTerm operator[](size_t term) const {
    return {*costs_[term].cost,    losses_[term],
            Loss(term) != nullptr, HasScale(*costs_[term].cost),
            scales_[term],         Factor(term),
            norms_[term]};
  }

 private:
  void CountMatches();

  // Whether a cost's sigmas are as uncertain as the matches' noise.
  static bool HasScale(const MotionCost& cost) {
    return cost.scale_group() != MotionCost::kFixedScale;
  }
  double EstimateScale(int group, const MotionDerivatives& motion,
                       double (*scale)(std::vector<double>* residuals));

  // The weight of a term in the sum, apart from its loss.
  double Factor(size_t term) const {
    return costs_[term].cost->information_factor() /
           (scales_[term] * scales_[term]);
  }

  // The loss of a term at its present width; null for least squares as it is.
  const ceres::LossFunction* Loss(size_t term) const {
    const bool is_plain = costs_[term].loss == nullptr && Factor(term) == 1.0;
    return is_plain ? nullptr : &losses_[term];
  }

  const std::vector<RobustCost> costs_;
  std::vector<ScaledLoss> losses_;
  std::vector<double> scales_;  // of each cost, equal within a group
  std::vector<std::vector<double>> norms_;  // squared, of each cost's blocks
  int num_used_ = 0;
  size_t num_matches_ = 0;

  // Memory that is used again.
  std::vector<double> new_scales_;
  std::vector<double> values_;
  std::vector<double> residuals_;
  std::vector<bool> counted_;
};

}  // namespace rgbd_pose
