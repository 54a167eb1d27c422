#pragma once

#include "core/estimation/estimator_options.h"
#include "core/estimation/motion_cost.h"
#include "core/estimation/robust_problem.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Minimum number of matches for six degrees of freedom.
constexpr int kMinMatches = 3;

// Of a motion by its own small changes.
MotionDerivatives DerivativesAt(const Rigid3d& cur_from_prev);

// Moves a guess to the least sum of terms, by Ceres: coarse to fine, losses
// from wide to narrow, scale and motion in turn.
class Minimiser {
 public:
  // Both must outlive it.
  Minimiser(const EstimatorOptions& options, RobustProblem* terms)
      : options_(options), terms_(*terms) {}

  // The terms are bound to a pair at a guess. `max_levels` as in FramePair.
  void Begin(const Rigid3d& guess, int max_levels);

  // False if the solver finds no finite step, or leaves too few matches.
  bool Run();

  // Where it is, by how many steps of the solver, and whether the last ones
  // came to rest.
  const Rigid3d& motion() const { return motion_; }
  int iterations() const { return iterations_; }
  bool converged() const { return converged_; }

 private:
  void SetLevel(int level);
  bool MinimiseWithScale(int level);
  int MaxScaleRounds(int level) const;
  bool Minimise();
  bool Associate(AssociationPolicy least);
  bool MinimiseLastStage();
  bool MinimiseStage(int max_iterations);
  double SettledWithin() const;
  bool SolveOnce(int max_iterations);

  const EstimatorOptions& options_;
  RobustProblem& terms_;

  // Of the run at hand.
  Rigid3d motion_;
  Rigid3d associated_at_;  // the motion at which weights are frozen
  int level_ = 0;
  int max_levels_ = 0;
  int iterations_ = 0;
  bool converged_ = false;
};

}  // namespace rgbd_pose
