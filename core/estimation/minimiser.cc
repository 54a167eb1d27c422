#include "core/estimation/minimiser.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>

namespace rgbd_pose {
namespace {

constexpr int kIterationsPerEarlyStage = 2;

// Maximum number of solves in the last stage. In between, residuals or weights
// that depend on the motion are chosen again if it has changed.
constexpr int kMaxAssociationRounds = 3;

// Frozen weights stay valid within this motion (rad and m): if noise is ten
// times larger along the ray than across it, a rotation by this angle adds 1 %
// to the variance across the ray.
constexpr double kFrozenWithin = 1e-2;

bool IsWithin(const Rigid3d& a, const Rigid3d& b, double limit) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() < limit && moved.translation.norm() < limit;
}

}  // namespace

bool Minimiser::Run(const Rigid3d& guess, int max_levels) {
  motion_ = guess;
  iterations_ = 0;
  converged_ = false;
  int levels = terms_.num_levels();
  if (max_levels > 0) levels = std::min(levels, max_levels);
  for (level_ = levels - 1; level_ >= 0; --level_) {
    associated_at_ = motion_;
    if (levels > 1) terms_.SetLevel(level_, motion_);
    if (terms_.num_used() < kMinMatches) return false;
    if (!MinimiseWithScale()) return false;
  }
  return true;
}

bool Minimiser::MinimiseWithScale() {
  terms_.ResetScales();
  if (!Minimise()) return false;
  // If residuals are chosen at every step, coarse levels only improve the
  // guess.
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

// All stages at one scale. Returns false if the solver found no finite step or
// too few matches remain.
bool Minimiser::Minimise() {
  double width = 1.0;
  if (terms_.has_losses() && options_.schedule == RobustSchedule::kGnc) {
    width = terms_.UpdateNorms(DerivativesAt(motion_));
  }
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
  return MinimiseLastStage();
}

// Associates at the current motion. Returns false if no cost needs it, or if
// the weights were frozen at a motion close enough.
bool Minimiser::AssociateIfMoved() {
  if (IsWithin(associated_at_, motion_, kFrozenWithin)) return false;
  associated_at_ = motion_;
  return terms_.Associate(AssociationPolicy::kWhenMoved, motion_);
}

// Weights that were frozen too far away need another round.
bool Minimiser::MinimiseLastStage() {
  for (int round = 1;; ++round) {
    if (!MinimiseStage(options_.max_iterations)) return false;
    if (round == kMaxAssociationRounds || !AssociateIfMoved()) {
      return true;
    }
    if (terms_.num_used() < kMinMatches) return false;
  }
}

bool Minimiser::MinimiseStage(int max_iterations) {
  if (!terms_.AsksFor(AssociationPolicy::kEveryStep)) {
    return SolveOnce(max_iterations);
  }
  // Step by step, each with fixed residuals: if they were chosen again within a
  // trial step, the solver would compare the costs of different residuals.
  converged_ = false;
  // Each coarser level has pixels twice as large and needs only half the
  // precision in pixels, since the next level continues from there.
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
bool Minimiser::SolveOnce(int max_iterations) {
  const LinearizationPoint origin(motion_);
  MotionVector x = MotionVector::Zero();
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = BlockOwnership(options_.assembly);
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  terms_.AddTo(options_.assembly, origin, x.data(), &problem);
  ceres::Solver::Options solver;
  // The fastest solver on the compressed block (docs/benchmarks.md). Its 7 x 6
  // Jacobian is triangular; squaring it just restores the Hessian.
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
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

}  // namespace rgbd_pose
