#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/estimation/estimator_options.h"
#include "core/estimation/motion_cost.h"
#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_problem.h"

namespace rgbd_pose {

// Estimates the motion between two frames: minimises the sum of all costs under
// their losses with Ceres, coarse to fine for costs with levels. Memory is
// reused between calls; one object serves one thread at a time.
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

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_pose
