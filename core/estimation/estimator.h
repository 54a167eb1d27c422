#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <string>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/estimation/motion_cost.h"
#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_problem.h"

namespace rgbd_pose {

// How losses reach their final widths.
enum class RobustSchedule {
  kDirect,  // at once: for a guess with residuals within the widths
  kGnc,     // graduated non-convexity: at first wide enough for all matches to
            // count, then narrower step by step
};

// The options of Estimator.
struct EstimatorOptions {
  // How matches become residual blocks; the result does not depend on it.
  Assembly assembly = Assembly::kCompressed;

  // How losses reach their final widths.
  RobustSchedule schedule = RobustSchedule::kGnc;

  // Each stage of the graduation narrows the losses by this factor (at least
  // 1.01), or directly to the spread of the residuals if this is narrower.
  double gnc_factor = 2.0;

  // Estimates the spread of residual components in units of the noise model, to
  // which the widths are adapted. May reorder its argument. Null: no scale.
  double (*scale)(std::vector<double>* residuals) = nullptr;

  // Scale and motion are estimated alternately, at most this many times.
  int max_scale_rounds = 10;

  // Smallest step (rad and m) if residuals are chosen again after every step.
  double step_tolerance = 1e-6;

  // Maximum iterations of the solver in the last stage; 2 in earlier ones.
  int max_iterations = 50;

  // The estimate is `inconsistent` if the share of inliers is below this.
  double min_inlier_share = 0.2;

  // The estimate is also `inconsistent` if as many matches would agree by
  // chance more often than this, see FalseAlarms; infinity: allowed.
  double max_false_alarms = 0.1;

  // The estimate is also `inconsistent` if the estimated scale exceeds this.
  double max_scale = 5.0;

  // A motion with a larger standard deviation (rad or m) is `degenerate`.
  double max_standard_deviation = 0.5;

  // For sums over tens of thousands of matches; results do not depend on it.
  int threads = 1;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Estimates the motion between two frames: minimises the sum of all costs under
// their losses, coarse to fine for costs with levels. Memory is reused between
// calls; one object serves one thread at a time.
class Estimator {
 public:
  // Minimises the sum of these costs. Throws InputError for invalid options.
  Estimator(const EstimatorOptions& options, std::vector<RobustCost> costs);
  // One cost; a null loss means least squares. A null cost throws InputError.
  Estimator(const EstimatorOptions& options, std::unique_ptr<MotionCost> cost,
            std::unique_ptr<ceres::LossFunction> loss);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  // `guess` is the solver's starting point; `prior` is for costs that use one.
  // Invalid data gives a status, never an abort.
  MotionEstimate Estimate(const Correspondences& matches,
                          const Rigid3d& guess = Rigid3d(),
                          const MotionPrior* prior = nullptr);

  // The same for any data the two frames share; reuses the memory of the
  // estimate. The options, not the pair, set the number of threads.
  void Estimate(const FramePair& pair, const Rigid3d& guess,
                MotionEstimate* estimate);

  // The motion of a body from the pairs of several cameras on it. MountCosts
  // makes the costs. The matches of the first pair come first in the estimate;
  // its FramePair::num_levels counts for all pairs. Throws InputError unless
  // there are as many pairs as the costs have cameras.
  void Estimate(const std::vector<FramePair>& pairs, const Rigid3d& guess,
                MotionEstimate* estimate);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_pose
