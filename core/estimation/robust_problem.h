#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/estimation/camera_mounting.h"
#include "core/estimation/motion_cost.h"

namespace rgbd_pose {

// A cost and the loss on each of its residual blocks.
struct RobustCost {
  std::unique_ptr<MotionCost> cost;           // must not be null
  std::unique_ptr<ceres::LossFunction> loss;  // null: least squares
};

// A term of a sum that is bound to a pair.
struct RobustTerm : RobustCost {
  // The index of the first match of its camera among the matches of all.
  size_t first_match = 0;
  double scale = 1.0;               // see RobustProblem::UpdateScales
  ScaledLoss scaled{nullptr, 1.0};  // the loss at its current width
  std::vector<double> norms = {};   // squared, one per block

  // Whether its sigmas share the unknown noise scale.
  bool has_scale() const {
    return cost->scale_group() != MotionCost::kFixedScale;
  }
  // Its weight in the sum, apart from the loss.
  double factor() const { return cost->information_factor() / (scale * scale); }
  // Whether `scaled` has no effect: plain least squares.
  bool is_plain() const { return loss == nullptr && factor() == 1.0; }
  // `scaled` for the functions of MotionCost; null if it has no effect.
  const ceres::LossFunction* scaled_or_null() const {
    return is_plain() ? nullptr : &scaled;
  }
};

// The sum that an estimator minimises, bound to one pair of each camera at a
// time.
class RobustProblem {
 public:
  // Throws InputError for a null cost, or if costs of one camera have different
  // mountings.
  explicit RobustProblem(std::vector<RobustCost> costs);

  // Binds and associates all costs, at the finest level and nominal widths.
  // Throws InputError unless there is a pair for each camera of the costs.
  void Bind(const std::vector<FramePair>& pairs, const Rigid3d& cur_from_prev);

  // The matches of each camera, and how many there are in all.
  const std::vector<CameraMatches>& cameras() const { return cameras_; }
  size_t num_matches() const { return num_matches_; }

  // Costs with fewer levels use their coarsest one for coarser levels.
  void SetLevel(int level, const Rigid3d& cur_from_prev);

  // Whether some cost must be associated at least as often as `least`.
  bool AsksFor(AssociationPolicy least) const;

  // Associates these costs again. Returns false if there are none.
  bool Associate(AssociationPolicy least, const Rigid3d& cur_from_prev);

  // Calls MotionCost::Reassociate of the costs associated at every step.
  void Reassociate(const Rigid3d& cur_from_prev);

  // Matches used by some cost plus blocks without a match, except priors.
  int num_used() const { return num_used_; }

  // Sets all losses to `width` times their widths at the current scales.
  void SetLosses(double width);

  // ScaledLoss::FlattenBelow the median of the noise's squared norms, for
  // losses that are steep at zero, until the next SetLosses: few matches fit so
  // many residuals exactly that their weights tell nothing. Returns false if no
  // loss is steep.
  bool FlattenLosses();

  void AddTo(Assembly assembly, const LinearizationPoint& origin, double* x,
             ceres::Problem* problem);

  NormalEquations Linearise(const MotionDerivatives& motion,
                            bool with_losses = true) const;

  // Updates the squared norms of all blocks. Returns their robust spread in
  // units of the noise model at the current scales, ideally 1.
  double UpdateNorms(const MotionDerivatives& motion);

  // The scale of a group of costs is the ratio of its noise to its noise model.
  // Without a noticeable change UpdateScales changes nothing and returns false.
  void ResetScales() {
    for (RobustTerm& term : terms_) term.scale = 1.0;
  }
  bool UpdateScales(const MotionDerivatives& motion,
                    double (*scale)(std::vector<double>* residuals));

  // The largest scale.
  double scale() const;

  const std::vector<RobustTerm>& terms() const { return terms_; }

 private:
  void CountMatches();
  double EstimateScale(int group, const MotionDerivatives& motion,
                       double (*scale)(std::vector<double>* residuals));

  std::vector<RobustTerm> terms_;
  std::vector<CameraMatches> cameras_;
  int num_used_ = 0;
  size_t num_matches_ = 0;

  // Reused memory.
  std::vector<double> new_scales_;
  std::vector<double> values_;
  std::vector<double> residuals_;
  std::vector<bool> counted_;
};

}  // namespace rgbd_pose
