#include "core/estimator.h"

#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "core/chi_squared.h"
#include "core/degeneracy.h"
#include "core/robust_covariance.h"
#include "core/scaled_loss.h"

namespace rgbd_pose {
namespace {

constexpr int kMinMatches = 3;
constexpr int kIterationsPerEarlyStage = 2;

// Scale and motion are estimated in turn until the scale moves by less.
constexpr double kScaleTolerance = 0.01;
constexpr int kMaxScaleRounds = 10;

// Frozen weights are taken as right within this (rad and m).
constexpr double kFrozenWithin = 2e-3;
constexpr int kMaxBindRounds = 3;

// Fewer residuals say nothing about their spread.
constexpr size_t kMinResidualsForScale = 10;
// What a scale may come to: a spread of zero (over half of the residuals
// equal) or a huge one (over half of the matches wrong) has no use.
constexpr double kMinScale = 0.05;
constexpr double kMaxScale = 20.0;

}  // namespace

std::string EstimatorOptions::Check() const {
  if (gnc_factor <= 1.0) return "gnc_factor must exceed 1";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (min_inlier_share < 0.0 || min_inlier_share > 1.0) {
    return "min_inlier_share must lie between 0 and 1";
  }
  if (max_scale <= 0.0) return "max_scale must be positive";
  if (threads < 1) return "threads must be at least 1";
  if (max_standard_deviation <= 0.0) {
    return "max_standard_deviation must be positive";
  }
  return "";
}

// The work of Estimate and its memory.
class Estimator::Solve {
 public:
  Solve(const EstimatorOptions& options, std::vector<RobustCost> costs)
      : options_(options), costs_(std::move(costs)), norms_(costs_.size()) {}

  void Run(const Correspondences& matches, const Rigid3d& guess,
           const MotionPrior* prior, MotionEstimate* estimate) {
    Reset(matches, guess, prior, estimate);
    if (out_->num_used < kMinMatches) {
      out_->status = EstimateStatus::kTooFewMatches;
      out_->reason =
          std::to_string(out_->num_used) + " usable matches, 3 are needed";
      if (matches.rejected() > 0) {
        out_->reason += "; " + std::to_string(matches.rejected()) +
                        " rejected as not finite";
      }
      return;
    }
    SetLosses(1.0);
    out_->initial_cost = Linearise().cost;
    if (MinimiseWithScale()) {
      Judge();
    } else {
      JudgeGuess(guess);
    }
  }

 private:
  void Reset(const Correspondences& matches, const Rigid3d& guess,
             const MotionPrior* prior, MotionEstimate* estimate) {
    matches_ = &matches;
    prior_ = prior;
    out_ = estimate;
    out_->reason.clear();
    out_->cur_from_prev = guess;
    out_->covariance.setZero();
    out_->weights.assign(matches.size(), 0.0);
    out_->is_inlier.assign(matches.size(), false);
    out_->num_inliers = 0;
    out_->sigma = 0.0;
    out_->final_cost = 0.0;
    out_->iterations = 0;
    converged_ = false;
    for (const RobustCost& term : costs_) Bind(term.cost.get());
    CountMatches();
  }

  void Bind(Cost* cost) {
    cost->Bind({*matches_, out_->cur_from_prev, prior_, options_.threads});
  }

  // Where weights are frozen, the matches used may change with the motion too.
  // False if no cost freezes any.
  bool BindAgain() {
    bool changed = false;
    for (const RobustCost& term : costs_) {
      if (!term.cost->freezes_weights()) continue;
      Bind(term.cost.get());
      changed = true;
    }
    if (changed) CountMatches();
    return changed;
  }

  void CountMatches() {
    num_blocks_ = 0;
    counted_.assign(matches_->size(), false);
    for (const RobustCost& term : costs_) {
      for (const int match : term.cost->matches()) {
        if (match >= 0) counted_[match] = true;
      }
      num_blocks_ += static_cast<int>(term.cost->matches().size());
    }
    out_->num_used =
        static_cast<int>(std::count(counted_.begin(), counted_.end(), true));
  }

  void SetLosses(double scale) {
    losses_.clear();
    for (const RobustCost& term : costs_) {
      losses_.emplace_back(term.loss.get(), scale);
    }
  }

  // The loss of a term at its present width; null for least squares.
  ceres::LossFunction* Loss(size_t term) {
    return costs_[term].loss ? &losses_[term] : nullptr;
  }

  MotionDerivatives MotionNow() const {
    const MotionVector zero = MotionVector::Zero();
    return MotionOrigin(out_->cur_from_prev).DerivativesAt(zero.data());
  }

  NormalEquations Linearise() {
    const MotionDerivatives motion = MotionNow();
    NormalEquations sum;
    for (size_t i = 0; i < costs_.size(); ++i) {
      costs_[i].cost->Linearise(motion, Loss(i), &sum);
    }
    return sum;
  }

  // Squared norms of all blocks at the motion so far; returns their robust
  // spread in units of the noise model, which is 1 for right matches.
  double UpdateNorms() {
    const MotionDerivatives motion = MotionNow();
    values_.clear();
    for (size_t i = 0; i < costs_.size(); ++i) {
      const Cost& cost = *costs_[i].cost;
      cost.SquaredNorms(motion, &norms_[i]);
      for (size_t k = 0; k < norms_[i].size(); ++k) {
        values_.push_back(norms_[i][k] / ChiSquaredMedian(cost.degrees()[k]));
      }
    }
    if (values_.empty()) return 0.0;
    const auto middle = values_.begin() + values_.size() / 2;
    std::nth_element(values_.begin(), middle, values_.end());
    return std::sqrt(*middle);
  }

  // The spread of residual components by the chosen scale estimator.
  double EstimateScale() {
    const MotionDerivatives motion = MotionNow();
    values_.clear();
    for (const RobustCost& term : costs_) {
      // The prior is no sample of the matches' noise.
      if (term.cost->matches().empty() || term.cost->matches()[0] < 0) continue;
      term.cost->Residuals(motion, &residuals_);
      // Rows that repeat each other are smaller by the root of how often.
      const int rows = term.cost->rows();
      const int degrees = term.cost->independent_rows();
      const double unit = std::sqrt(static_cast<double>(rows) / degrees);
      for (size_t i = 0; i < residuals_.size(); ++i) {
        // What a match did not measure leaves rows of zeros.
        if (term.cost->degrees()[i / rows] < degrees) continue;
        values_.push_back(unit * residuals_[i]);
      }
    }
    if (values_.size() < kMinResidualsForScale) return 1.0;
    return std::clamp(options_.scale(&values_), kMinScale, kMaxScale);
  }

  bool MinimiseWithScale() {
    scale_ = 1.0;
    if (!Minimise()) return false;
    for (int i = 0; options_.scale != nullptr && i < kMaxScaleRounds; ++i) {
      const double scale = EstimateScale();
      const bool settled = std::abs(scale - scale_) <= kScaleTolerance * scale_;
      if (settled) break;
      scale_ = scale;
      if (!Minimise()) return false;
    }
    return true;
  }

  // All stages at one scale. False if the solver found no finite step.
  bool Minimise() {
    const bool robust = std::any_of(
        costs_.begin(), costs_.end(),
        [](const RobustCost& term) { return term.loss != nullptr; });
    double width = 1.0;
    if (robust && options_.schedule == RobustSchedule::kGnc) {
      width = UpdateNorms() / scale_;
    }
    while (width > 1.0) {
      SetLosses(scale_ * width);
      if (!MinimiseStage(kIterationsPerEarlyStage)) return false;
      BindAgain();
      if (out_->num_used < kMinMatches) return false;
      // Where over half of the matches are right they soon agree, and most
      // stages are saved.
      width = std::min(width / options_.gnc_factor, UpdateNorms() / scale_);
    }
    SetLosses(scale_);
    return MinimiseLastStage();
  }

  // Weights that were frozen at a motion too far away ask for another round.
  bool MinimiseLastStage() {
    for (int round = 1;; ++round) {
      const Rigid3d before = out_->cur_from_prev;
      if (!MinimiseStage(options_.max_iterations)) return false;
      const Rigid3d moved = before.Inverse() * out_->cur_from_prev;
      if (round == kMaxBindRounds ||
          (moved.Angle() < kFrozenWithin &&
           moved.translation.norm() < kFrozenWithin)) {
        return true;
      }
      if (!BindAgain()) return true;
      if (out_->num_used < kMinMatches) return false;
    }
  }

  bool MinimiseStage(int max_iterations) {
    const MotionOrigin origin(out_->cur_from_prev);
    MotionVector x = MotionVector::Zero();
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = BlockOwnership(options_.assembly);
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    ceres::Problem problem(problem_options);
    for (size_t i = 0; i < costs_.size(); ++i) {
      costs_[i].cost->AddTo(options_.assembly, origin, Loss(i), x.data(),
                            &problem);
    }
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
    out_->iterations += static_cast<int>(summary.iterations.size()) - 1;
    converged_ = summary.termination_type == ceres::CONVERGENCE;
    if (!summary.IsSolutionUsable() || !x.allFinite()) return false;
    out_->cur_from_prev = origin.CurFromPrev(x.data());
    return true;
  }

  // After the solver found no step, or one that leaves all matches behind: the
  // matches at the guess, taken as right, may tell why.
  void JudgeGuess(const Rigid3d& guess) {
    out_->cur_from_prev = guess;
    BindAgain();
    NormalEquations sum;
    for (const RobustCost& term : costs_) {
      term.cost->Linearise(MotionNow(), nullptr, &sum);
    }
    const Degeneracy degeneracy = FindDegeneracy(
        sum.hessian, num_blocks_, options_.max_standard_deviation);
    out_->status = degeneracy.is_degenerate ? EstimateStatus::kDegenerate
                                            : EstimateStatus::kNotConverged;
    out_->reason = degeneracy.is_degenerate ? degeneracy.reason
                                            : "the solver found no usable step";
  }

  void Judge() {
    out_->sigma = UpdateNorms();
    JudgeMatches();
    const NormalEquations sum = Linearise();
    out_->final_cost = sum.cost;
    const Degeneracy degeneracy = FindDegeneracy(
        sum.hessian, loss_sums_.weight, options_.max_standard_deviation);
    if (degeneracy.is_degenerate) {
      out_->status = EstimateStatus::kDegenerate;
      out_->reason = degeneracy.reason;
      return;
    }
    weighted_.clear();
    for (size_t i = 0; i < costs_.size(); ++i) {
      weighted_.push_back({costs_[i].cost.get(), Loss(i)});
    }
    out_->covariance = RobustCovariance(weighted_, MotionNow(), loss_sums_,
                                        degeneracy.inverse);
    const double share =
        static_cast<double>(out_->num_inliers) / out_->num_used;
    out_->status = EstimateStatus::kOk;
    if (scale_ > options_.max_scale) {
      out_->status = EstimateStatus::kInconsistent;
      out_->reason = "residuals are " + std::to_string(scale_) +
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

  // Fills weights and inliers from the norms and sums up what the covariance
  // needs of the losses.
  void JudgeMatches() {
    loss_sums_ = LossSums();
    counted_.assign(out_->weights.size(), false);
    for (size_t i = 0; i < costs_.size(); ++i) {
      const Cost& cost = *costs_[i].cost;
      for (size_t k = 0; k < norms_[i].size(); ++k) {
        const int p = cost.degrees()[k];
        const double limit = ChiSquared99(p) * scale_ * scale_;
        const double s = norms_[i][k];
        double rho[3];
        losses_[i].Evaluate(s, rho);
        loss_sums_.Add(rho, s, p);
        const int match = cost.matches()[k];
        // Losses that are steeper than least squares near 0 weigh above 1.
        if (match >= 0) JudgeMatch(match, std::min(rho[1], 1.0), s <= limit);
      }
    }
    out_->num_inliers = static_cast<int>(
        std::count(out_->is_inlier.begin(), out_->is_inlier.end(), true));
  }

  // A match that several costs use is an inlier if all of them agree.
  void JudgeMatch(int match, double weight, bool agrees) {
    const bool again = counted_[match];
    out_->is_inlier[match] = agrees && (!again || out_->is_inlier[match]);
    out_->weights[match] =
        again ? std::min(out_->weights[match], weight) : weight;
    counted_[match] = true;
  }

  const EstimatorOptions options_;
  const std::vector<RobustCost> costs_;

  // Of the call at hand.
  const Correspondences* matches_ = nullptr;
  const MotionPrior* prior_ = nullptr;
  MotionEstimate* out_ = nullptr;
  double scale_ = 1.0;
  bool converged_ = false;
  int num_blocks_ = 0;
  LossSums loss_sums_;

  // Memory that is used again.
  std::vector<ScaledLoss> losses_;
  std::vector<WeightedCost> weighted_;
  std::vector<std::vector<double>> norms_;
  std::vector<double> values_;
  std::vector<double> residuals_;
  std::vector<bool> counted_;
};

Estimator::Estimator(const EstimatorOptions& options,
                     std::vector<RobustCost> costs)
    : solve_(std::make_unique<Solve>(options, std::move(costs))) {}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

MotionEstimate Estimator::Estimate(const Correspondences& matches,
                                   const Rigid3d& guess,
                                   const MotionPrior* prior) {
  MotionEstimate estimate;
  Estimate(matches, guess, prior, &estimate);
  return estimate;
}

void Estimator::Estimate(const Correspondences& matches, const Rigid3d& guess,
                         const MotionPrior* prior, MotionEstimate* estimate) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  solve_->Run(matches, guess, prior, estimate);
  estimate->solve_ms =
      std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace rgbd_pose
