#include "core/estimation/minimiser.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>

namespace rgbd_pose {
namespace {

constexpr int kIterationsPerEarlyStage = 2;

// Frozen weights are taken as right within this (rad and m): a turn by it adds
// 1 % of the variance along the ray to that across it, where noise is ten times
// larger along the ray.
constexpr double kFrozenWithin = 1e-2;

bool IsWithin(const Rigid3d& a, const Rigid3d& b, double limit) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() < limit && moved.translation.norm() < limit;
}

}  // namespace

MotionDerivatives DerivativesAt(const Rigid3d& cur_from_prev) {
  const MotionVector zero = MotionVector::Zero();
  return LinearizationPoint(cur_from_prev).DerivativesAt(zero.data());
}

void Minimiser::Begin(const Rigid3d& guess, int max_levels) {
  motion_ = guess;
  associated_at_ = guess;
  level_ = 0;
  max_levels_ = max_levels;
  iterations_ = 0;
  converged_ = false;
}

bool Minimiser::Run() {
  int levels = terms_.num_levels();
  if (max_levels_ > 0) levels = std::min(levels, max_levels_);
  for (int level = levels - 1; level >= 0; --level) {
    if (levels > 1) SetLevel(level);
    if (terms_.num_used() < kMinMatches) return false;
    if (!MinimiseWithScale(level)) return false;
  }
  return true;
}

void Minimiser::SetLevel(int level) {
  level_ = level;
  associated_at_ = motion_;
  terms_.SetLevel(level, motion_);
}

bool Minimiser::MinimiseWithScale(int level) {
  terms_.ResetScales();
  if (!Minimise()) return false;
  if (options_.scale == nullptr) return true;
  for (int i = 0; i < MaxScaleRounds(level); ++i) {
    if (!terms_.UpdateScales(DerivativesAt(motion_), options_.scale)) break;
    if (!Minimise()) return false;
  }
  return true;
}

// Where residuals are chosen at every step, coarse levels only lead on.
int Minimiser::MaxScaleRounds(int level) const {
  return level > 0 && terms_.AsksFor(AssociationPolicy::kEveryStep)
             ? 0
             : options_.max_scale_rounds;
}

// All stages at one scale. False if the solver found no finite step.
bool Minimiser::Minimise() {
  double width = 1.0;
  if (terms_.has_losses() && options_.schedule == RobustSchedule::kGnc) {
    width = terms_.UpdateNorms(DerivativesAt(motion_));
  }
  while (width > 1.0) {
    terms_.SetLosses(width);
    if (!MinimiseStage(kIterationsPerEarlyStage)) return false;
    Associate(AssociationPolicy::kWhenMoved);
    if (terms_.num_used() < kMinMatches) return false;
    // Where over half of the matches are right they soon agree, and most
    // stages are saved.
    width = std::min(width / options_.gnc_factor,
                     terms_.UpdateNorms(DerivativesAt(motion_)));
  }
  terms_.SetLosses(1.0);
  return MinimiseLastStage();
}

// At the motion so far. False if no cost asks for it so often, or if what is
// frozen was so near enough.
bool Minimiser::Associate(AssociationPolicy least) {
  if (least != AssociationPolicy::kEveryStep) {
    if (IsWithin(associated_at_, motion_, kFrozenWithin)) return false;
    associated_at_ = motion_;
  }
  return terms_.Associate(least, motion_);
}

// Weights that were frozen at a motion too far away ask for another round.
bool Minimiser::MinimiseLastStage() {
  for (int round = 1;; ++round) {
    if (!MinimiseStage(options_.max_iterations)) return false;
    if (round == options_.max_association_rounds ||
        !Associate(AssociationPolicy::kWhenMoved)) {
      return true;
    }
    if (terms_.num_used() < kMinMatches) return false;
  }
}

bool Minimiser::MinimiseStage(int max_iterations) {
  if (!terms_.AsksFor(AssociationPolicy::kEveryStep)) {
    return SolveOnce(max_iterations);
  }
  // Step by step, each of the residuals as they are: were they chosen again
  // within a step's trial, the solver would compare costs of other residuals.
  converged_ = false;
  for (int i = 0; i < max_iterations && !converged_; ++i) {
    const Rigid3d before = motion_;
    if (!SolveOnce(1)) return false;
    converged_ = converged_ || IsWithin(before, motion_, SettledWithin());
    terms_.Reassociate(motion_);
    if (terms_.num_used() < kMinMatches) return false;
  }
  return true;
}

// Pixels of each level are twice as large as those of the next finer one, and
// need be hit half as well: that goes on from there.
double Minimiser::SettledWithin() const {
  return options_.step_tolerance * (1 << 2 * level_);
}

// Of the residuals as they are associated.
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
  // The fastest on the compressed block (docs/benchmarks.md); its 7 x 6
  // Jacobian is triangular, so squaring it only gives the Hessian back.
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;
  solver.max_num_iterations = max_iterations;
  solver.function_tolerance = 1e-9;
  solver.parameter_tolerance = 1e-9;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  // There are none if the cost at the start is not finite.
  iterations_ += std::max(static_cast<int>(summary.iterations.size()) - 1, 0);
  converged_ = summary.termination_type == ceres::CONVERGENCE;
  if (!summary.IsSolutionUsable() || !x.allFinite()) return false;
  motion_ = origin.CurFromPrev(x.data());
  return true;
}

}  // namespace rgbd_pose
