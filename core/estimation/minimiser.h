#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>

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
  bool Run(const Rigid3d& guess, int max_levels) {
    motion_ = guess;
    iterations_ = 0;
    converged_ = false;
    int levels = 1;
    bool has_losses = false;
    for (const RobustTerm& term : terms_.terms()) {
      levels = std::max(levels, term.cost->num_levels());
      has_losses = has_losses || term.loss != nullptr;
    }
    is_graduated_ = has_losses && options_.schedule == RobustSchedule::kGnc;
    if (max_levels > 0) levels = std::min(levels, max_levels);
    for (level_ = levels - 1; level_ >= 0; --level_) {
      associated_at_ = motion_;
      if (levels > 1) terms_.SetLevel(level_, motion_);
      if (terms_.num_used() < kMinMatches) return false;
      if (!MinimiseWithScale()) return false;
    }
    return true;
  }

  // The motion, the number of solver steps, whether the last solve converged.
  const Rigid3d& motion() const { return motion_; }
  int iterations() const { return iterations_; }
  bool converged() const { return converged_; }

 private:
  static bool IsWithin(const Rigid3d& a, const Rigid3d& b, double limit) {
    const Rigid3d moved = a.Inverse() * b;
    return moved.Angle() < limit && moved.translation.norm() < limit;
  }

  bool MinimiseWithScale() {
    terms_.ResetScales();
    if (!Minimise()) return false;
    // Coarse levels of costs associated at every step only improve the guess.
    if (options_.scale == nullptr ||
        (level_ > 0 && terms_.AsksFor(AssociationPolicy::kEveryStep))) {
      return true;
    }
    for (int i = 0; i < options_.max_scale_rounds; ++i) {
      if (!terms_.UpdateScales(DerivativesAt(motion_), options_.scale)) break;
      if (!Minimise()) return false;
    }
    return true;
  }

  // All stages at one scale. Returns as Run.
  bool Minimise() {
    constexpr int kIterationsPerEarlyStage = 2;
    double width = 1.0;
    if (is_graduated_) width = terms_.UpdateNorms(DerivativesAt(motion_));
    while (width > 1.0) {
      terms_.SetLosses(width);
      if (!MinimiseStage(kIterationsPerEarlyStage)) return false;
      AssociateIfMoved();
      if (terms_.num_used() < kMinMatches) return false;
      // If over half of the matches are right, this soon skips most stages.
      width = std::min(width / options_.gnc_factor,
                       terms_.UpdateNorms(DerivativesAt(motion_)));
    }
    terms_.SetLosses(1.0);
    // Weights that were frozen too far away need another solve.
    constexpr int kMaxLastStages = 3;
    for (int stage = 1;; ++stage) {
      if (!MinimiseStage(options_.max_iterations)) return false;
      if (stage == kMaxLastStages || !AssociateIfMoved()) return true;
      if (terms_.num_used() < kMinMatches) return false;
    }
  }

  // Returns false if no cost needs it, or frozen weights are close enough.
  bool AssociateIfMoved() {
    // rad and m. If noise is ten times larger along the ray than across it, a
    // rotation by this angle adds 1 % to the variance across the ray.
    constexpr double kFrozenWithin = 1e-2;
    if (IsWithin(associated_at_, motion_, kFrozenWithin)) return false;
    associated_at_ = motion_;
    return terms_.Associate(AssociationPolicy::kWhenMoved, motion_);
  }

  bool MinimiseStage(int max_iterations) {
    if (!terms_.AsksFor(AssociationPolicy::kEveryStep)) {
      return SolveOnce(max_iterations);
    }
    // Step by step: costs of different residuals must not be compared.
    converged_ = false;
    // Each coarser level has larger pixels and needs only half the precision.
    const double settled = options_.step_tolerance * (1 << 2 * level_);
    for (int i = 0; i < max_iterations && !converged_; ++i) {
      const Rigid3d before = motion_;
      if (!SolveOnce(1)) return false;
      converged_ = converged_ || IsWithin(before, motion_, settled);
      terms_.Reassociate(motion_);
      if (terms_.num_used() < kMinMatches) return false;
    }
    return true;
  }

  // Solves with the currently associated residuals.
  bool SolveOnce(int max_iterations) {
    const LinearizationPoint origin(motion_);
    MotionVector x = MotionVector::Zero();
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = BlockOwnership(options_.assembly);
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    ceres::Problem problem(problem_options);
    terms_.AddTo(options_.assembly, origin, x.data(), &problem);
    ceres::Solver::Options solver;
    // The fastest solver on the compressed block (docs/benchmarks.md). Its 7 x
    // 6 Jacobian is triangular; squaring it just restores the Hessian.
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.logging_type = ceres::SILENT;
    // Some damping always stays, 1e-14 of the Hessian. Without it the
    // factorization fails where nothing determines the motion, and Ceres logs a
    // warning.
    solver.max_trust_region_radius = 1e14;
    solver.num_threads = 1;
    solver.max_num_iterations = max_iterations;
    solver.function_tolerance = 1e-9;
    solver.parameter_tolerance = 1e-9;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    // There are no iterations if the initial cost is not finite.
    iterations_ += std::max(static_cast<int>(summary.iterations.size()) - 1, 0);
    converged_ = summary.termination_type == ceres::CONVERGENCE;
    if (!summary.IsSolutionUsable() || !x.allFinite()) return false;
    motion_ = origin.CurFromPrev(x.data());
    return true;
  }

  const EstimatorOptions& options_;
  RobustProblem& terms_;

  // State of the current run.
  Rigid3d motion_;
  Rigid3d associated_at_;  // the motion at which the weights were chosen
  bool is_graduated_ = false;
  int level_ = 0;
  int iterations_ = 0;
  bool converged_ = false;
};

}  // namespace rgbd_pose
