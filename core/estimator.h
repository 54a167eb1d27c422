#pragma once

#include <ceres/loss_function.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/correspondences.h"
#include "core/cost.h"
#include "core/motion_estimate.h"

namespace rgbd_pose {

// Makes a loss whose width is `scale` times its nominal one.
using LossFactory =
    std::function<std::unique_ptr<ceres::LossFunction>(double scale)>;

// A cost and the loss on each of its blocks.
struct RobustCost {
  std::unique_ptr<Cost> cost;
  LossFactory loss;  // empty: no loss (least squares)
};

struct EstimatorOptions {
  Assembly assembly = Assembly::kCompressed;

  // Whether to start with losses so wide that all matches count and to narrow
  // them step by step (graduated non-convexity). Redescending losses need it
  // unless the guess is within their width.
  bool graduate = true;

  // Each stage of the graduation narrows the losses by this factor.
  double graduation_factor = 2.0;

  // Of the solver, in the last stage; the stages before take at most three.
  int max_iterations = 50;

  // The estimate is `inconsistent` if a smaller share of matches agrees.
  double min_inlier_share = 0.2;

  // A direction of motion is `degenerate` if its standard deviation exceeds
  // this (rad for rotation, m for translation).
  double max_standard_deviation = 0.5;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Estimates the motion between two frames from matches: minimises the sum of
// all costs under their losses with Ceres. Keeps its memory between calls; one
// object serves one thread at a time.
class Estimator {
 public:
  Estimator(const EstimatorOptions& options, std::vector<RobustCost> costs);
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  // `guess` is where the solver starts. Bad data is a status, never an abort.
  MotionEstimate Estimate(const Correspondences& correspondences,
                          const Rigid3d& guess = Rigid3d());

 private:
  class Solve;
  EstimatorOptions options_;
  std::vector<RobustCost> costs_;
};

}  // namespace rgbd_pose
