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
// their losses with Ceres, coarse to fine where costs have levels. Keeps its
// memory between calls; one object serves one thread at a time.
class Estimator {
 public:
  // Minimises the sum of these costs. Throws InputError for options that are
  // not sound (see Check).
  Estimator(const EstimatorOptions& options, std::vector<RobustCost> costs);
  // Of one cost; a null loss is least squares. Throws InputError without cost.
  Estimator(const EstimatorOptions& options, std::unique_ptr<MotionCost> cost,
            std::unique_ptr<ceres::LossFunction> loss);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  // `guess` is where the solver starts; `prior` is that of costs
  // that use one. Bad data is a status, never an abort.
  MotionEstimate Estimate(const Correspondences& matches,
                          const Rigid3d& guess = Rigid3d(),
                          const MotionPrior* prior = nullptr);

  // The same of whatever the two frames share, into an estimate whose memory is
  // used again. The options say how many threads, not the pair.
  void Estimate(const FramePair& pair, const Rigid3d& guess,
                MotionEstimate* estimate);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_pose
