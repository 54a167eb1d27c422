#include "core/estimation/estimator.h"

#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "core/estimation/degeneracy.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kMinMatches = 3;
constexpr int kIterationsPerEarlyStage = 2;

// Frozen weights are taken as right within this (rad and m): a turn by it adds
// 1 % of the variance along the ray to that across it, where noise is ten times
// larger along the ray.
constexpr double kFrozenWithin = 1e-2;

bool IsWithin(const Rigid3d& a, const Rigid3d& b, double limit) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() < limit && moved.translation.norm() < limit;
}

std::vector<RobustCost> TermsOf(std::unique_ptr<MotionCost> cost,
                                std::unique_ptr<ceres::LossFunction> loss) {
  if (cost == nullptr) throw InputError("an estimator needs a cost");
  std::vector<RobustCost> terms;
  terms.push_back({std::move(cost), std::move(loss)});
  return terms;
}

}  // namespace

std::string EstimatorOptions::Check() const {
  // Written so that a NaN fails each of them.
  if (!(gnc_factor >= 1.01)) return "gnc_factor must be at least 1.01";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (!(min_inlier_share >= 0.0 && min_inlier_share <= 1.0)) {
    return "min_inlier_share must lie between 0 and 1";
  }
  if (!(max_scale > 0.0)) return "max_scale must be positive";
  if (max_scale_rounds < 0) return "max_scale_rounds must not be negative";
  if (max_association_rounds < 1) {
    return "max_association_rounds must be at least 1";
  }
  if (threads < 1) return "threads must be at least 1";
  if (!(settled_within > 0.0)) return "settled_within must be positive";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  return "";
}

// The work of Estimate and its memory.
class Estimator::Solve {
 public:
  Solve(const EstimatorOptions& options, std::vector<RobustCost> costs)
      : options_(options), terms_(std::move(costs)) {
    const std::string problem = options.Check();
    if (!problem.empty()) throw InputError("estimator: " + problem);
  }

  void Run(const PairData& pair, const Rigid3d& guess,
           MotionEstimate* estimate) {
    Reset(pair, guess, estimate);
    if (out_->num_used < kMinMatches) {
      out_->status = EstimateStatus::kTooFewMatches;
      out_->reason =
          std::to_string(out_->num_used) + " usable matches, 3 are needed";
      if (matches_->rejected() > 0) {
        out_->reason += "; " + std::to_string(matches_->rejected()) +
                        " rejected as not finite";
      }
      return;
    }
    if (MinimiseCoarseToFine()) {
      Judge(guess);
    } else {
      JudgeGuess(guess);
    }
  }

 private:
  void Reset(const PairData& pair, const Rigid3d& guess,
             MotionEstimate* estimate) {
    static const Correspondences kNone;
    matches_ = pair.matches != nullptr ? pair.matches : &kNone;
    out_ = estimate;
    out_->reason.clear();
    out_->cur_from_prev = guess;
    out_->covariance.setZero();
    out_->weights.assign(matches_->size(), 0.0);
    out_->is_inlier.assign(matches_->size(), false);
    out_->residual_norms.assign(matches_->size(), 0.0);
    out_->residual_degrees.assign(matches_->size(), 0);
    out_->num_inliers = 0;
    out_->sigma = 0.0;
    out_->initial_cost = 0.0;
    out_->final_cost = 0.0;
    out_->iterations = 0;
    converged_ = false;
    level_ = 0;
    max_levels_ = pair.num_levels;
    associated_at_ = guess;
    PairData data = pair;
    data.threads = options_.threads;
    terms_.Bind(data, guess);
    out_->num_used = terms_.num_used();
  }

  // At the motion so far. False if no cost asks for it so often, or if what is
  // frozen was so near enough.
  bool Associate(Association least) {
    const Rigid3d& motion = out_->cur_from_prev;
    if (least != Association::kEveryStep) {
      if (IsWithin(associated_at_, motion, kFrozenWithin)) return false;
      associated_at_ = motion;
    }
    const bool changed = terms_.Associate(least, motion);
    out_->num_used = terms_.num_used();
    return changed;
  }

  void SetLevel(int level) {
    level_ = level;
    associated_at_ = out_->cur_from_prev;
    terms_.SetLevel(level, out_->cur_from_prev);
    out_->num_used = terms_.num_used();
  }

  MotionDerivatives MotionNow() const { return At(out_->cur_from_prev); }

  static MotionDerivatives At(const Rigid3d& cur_from_prev) {
    const MotionVector zero = MotionVector::Zero();
    return MotionOrigin(cur_from_prev).DerivativesAt(zero.data());
  }

  bool MinimiseCoarseToFine() {
    int levels = terms_.num_levels();
    if (max_levels_ > 0) levels = std::min(levels, max_levels_);
    for (int level = levels - 1; level >= 0; --level) {
      if (levels > 1) SetLevel(level);
      if (out_->num_used < kMinMatches) return false;
      if (!MinimiseWithScale(level)) return false;
    }
    return true;
  }

  bool MinimiseWithScale(int level) {
    terms_.ResetScales();
    if (!Minimise()) return false;
    if (options_.scale == nullptr) return true;
    for (int i = 0; i < MaxScaleRounds(level); ++i) {
      if (!terms_.UpdateScales(MotionNow(), options_.scale)) break;
      if (!Minimise()) return false;
    }
    return true;
  }

  // Where residuals are chosen at every step, coarse levels only lead on.
  int MaxScaleRounds(int level) const {
    return level > 0 && terms_.AsksFor(Association::kEveryStep)
               ? 0
               : options_.max_scale_rounds;
  }

  // All stages at one scale. False if the solver found no finite step.
  bool Minimise() {
    double width = 1.0;
    if (terms_.has_losses() && options_.schedule == RobustSchedule::kGnc) {
      width = terms_.UpdateNorms(MotionNow());
    }
    while (width > 1.0) {
      terms_.SetLosses(width);
      if (!MinimiseStage(kIterationsPerEarlyStage)) return false;
      Associate(Association::kWhenMoved);
      if (out_->num_used < kMinMatches) return false;
      // Where over half of the matches are right they soon agree, and most
      // stages are saved.
      width = std::min(width / options_.gnc_factor,
                       terms_.UpdateNorms(MotionNow()));
    }
    terms_.SetLosses(1.0);
    return MinimiseLastStage();
  }

  // Weights that were frozen at a motion too far away ask for another round.
  bool MinimiseLastStage() {
    for (int round = 1;; ++round) {
      if (!MinimiseStage(options_.max_iterations)) return false;
      if (round == options_.max_association_rounds ||
          !Associate(Association::kWhenMoved)) {
        return true;
      }
      if (out_->num_used < kMinMatches) return false;
    }
  }

  bool MinimiseStage(int max_iterations) {
    if (!terms_.AsksFor(Association::kEveryStep)) {
      return SolveOnce(max_iterations);
    }
    // Step by step, each of the residuals as they are: were they chosen anew
    // within a step's trial, the solver would compare costs of other residuals.
    converged_ = false;
    for (int i = 0; i < max_iterations && !converged_; ++i) {
      const Rigid3d before = out_->cur_from_prev;
      if (!SolveOnce(1)) return false;
      converged_ =
          converged_ || IsWithin(before, out_->cur_from_prev, SettledWithin());
      terms_.Follow(out_->cur_from_prev);
      out_->num_used = terms_.num_used();
      if (out_->num_used < kMinMatches) return false;
    }
    return true;
  }

  // Pixels of each level are twice as large as those of the next finer one, and
  // need be hit half as well: that goes on from there.
  double SettledWithin() const {
    return options_.settled_within * (1 << 2 * level_);
  }

  // Of the residuals as they are associated.
  bool SolveOnce(int max_iterations) {
    const MotionOrigin origin(out_->cur_from_prev);
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
    out_->iterations +=
        std::max(static_cast<int>(summary.iterations.size()) - 1, 0);
    converged_ = summary.termination_type == ceres::CONVERGENCE;
    if (!summary.IsSolutionUsable() || !x.allFinite()) return false;
    out_->cur_from_prev = origin.CurFromPrev(x.data());
    return true;
  }

  // After the solver found no step, or one that leaves all matches behind: the
  // matches at the guess, taken as right, may tell why.
  void JudgeGuess(const Rigid3d& guess) {
    out_->cur_from_prev = guess;
    SetLevel(0);
    const NormalEquations sum = terms_.LineariseWithoutLosses(MotionNow());
    const Degeneracy degeneracy =
        FindDegeneracy(sum.hessian, FeignedInformation(*matches_, {}),
                       options_.max_standard_deviation);
    out_->status = degeneracy.is_degenerate ? EstimateStatus::kDegenerate
                                            : EstimateStatus::kNotConverged;
    out_->reason = degeneracy.is_degenerate ? degeneracy.reason
                                            : "the solver found no usable step";
  }

  void Judge(const Rigid3d& guess) {
    out_->sigma = terms_.UpdateNorms(MotionNow()) * terms_.scale();
    terms_.JudgeMatches(out_);
    const NormalEquations sum = terms_.LineariseShares(MotionNow());
    out_->initial_cost = terms_.Linearise(At(guess)).cost;
    out_->final_cost = sum.cost;
    const Degeneracy degeneracy = FindDegeneracy(
        sum.hessian, FeignedInformation(*matches_, out_->weights),
        options_.max_standard_deviation);
    if (degeneracy.is_degenerate) {
      out_->status = EstimateStatus::kDegenerate;
      out_->reason = degeneracy.reason;
      return;
    }
    out_->covariance = terms_.Covariance(MotionNow(), degeneracy.inverse);
    const double share =
        static_cast<double>(out_->num_inliers) / out_->num_used;
    out_->status = EstimateStatus::kOk;
    if (terms_.scale() > options_.max_scale) {
      out_->status = EstimateStatus::kInconsistent;
      out_->reason = "residuals are " + std::to_string(terms_.scale()) +
                     " times what the noise model says";
    } else if (share < options_.min_inlier_share) {
      out_->status = EstimateStatus::kInconsistent;
      out_->reason = "only " + std::to_string(out_->num_inliers) + " of " +
                     std::to_string(out_->num_used) +
                     " matches agree with one motion";
    } else if (!converged_) {
      out_->status = EstimateStatus::kNotConverged;
      out_->reason =
          "stopped after " + std::to_string(out_->iterations) + " iterations";
    }
  }

  const EstimatorOptions options_;
  RobustTerms terms_;

  // Of the call at hand.
  const Correspondences* matches_ = nullptr;
  MotionEstimate* out_ = nullptr;
  Rigid3d associated_at_;  // the motion at which weights are frozen
  int level_ = 0;
  int max_levels_ = 0;  // see PairData
  bool converged_ = false;
};

Estimator::Estimator(const EstimatorOptions& options,
                     std::vector<RobustCost> costs)
    : solve_(std::make_unique<Solve>(options, std::move(costs))) {}

Estimator::Estimator(const EstimatorOptions& options,
                     std::unique_ptr<MotionCost> cost,
                     std::unique_ptr<ceres::LossFunction> loss)
    : Estimator(options, TermsOf(std::move(cost), std::move(loss))) {}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

MotionEstimate Estimator::Estimate(const Correspondences& matches,
                                   const Rigid3d& guess,
                                   const MotionPrior* prior) {
  MotionEstimate estimate;
  Estimate({&matches, prior}, guess, &estimate);
  return estimate;
}

void Estimator::Estimate(const PairData& pair, const Rigid3d& guess,
                         MotionEstimate* estimate) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  solve_->Run(pair, guess, estimate);
  estimate->solve_ms =
      std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace rgbd_pose
