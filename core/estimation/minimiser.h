#pragma once

#include "core/estimation/estimator.h"
#include "core/estimation/robust_problem.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Minimum number of matches for six degrees of freedom.
constexpr int kMinMatches = 3;

// Minimises the sum of terms with Ceres, starting at a guess: coarse to fine,
// losses from wide to narrow, scale and motion alternately.
class Minimiser {
 public:
  // Both arguments must outlive this object.
  Minimiser(const EstimatorOptions& options, RobustProblem* terms)
      : options_(options), terms_(*terms) {}

  // Terms must be bound to a pair at the guess; `max_levels` as in FramePair.
  // Returns false if the solver finds no finite step or too few matches remain.
  bool Run(const Rigid3d& guess, int max_levels);

  // The motion, the number of solver steps, whether the last solve converged.
  const Rigid3d& motion() const { return motion_; }
  int iterations() const { return iterations_; }
  bool converged() const { return converged_; }

 private:
  bool MinimiseWithScale();
  bool Minimise();
  bool AssociateIfMoved();
  bool MinimiseLastStage();
  bool MinimiseStage(int max_iterations);
  bool SolveOnce(int max_iterations);

  const EstimatorOptions& options_;
  RobustProblem& terms_;

  // State of the current run.
  Rigid3d motion_;
  Rigid3d associated_at_;  // the motion at which the weights were chosen
  int level_ = 0;
  int iterations_ = 0;
  bool converged_ = false;
};

}  // namespace rgbd_pose
