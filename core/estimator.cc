#include "core/estimator.h"

#include <ceres/solver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "core/chi_squared.h"
#include "core/degeneracy.h"

namespace rgbd_pose {
namespace {

constexpr int kMinMatches = 3;
constexpr int kIterationsPerEarlyStage = 3;

// rho, rho', rho'' of a loss at s; a null loss is rho = s.
struct LossValue {
  double rho[3];
  LossValue(const ceres::LossFunction* loss, double s) : rho{s, 1.0, 0.0} {
    if (loss != nullptr) loss->Evaluate(s, rho);
  }
};

double Median(std::vector<double>* values) {
  const auto middle = values->begin() + values->size() / 2;
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace

std::string EstimatorOptions::Check() const {
  if (graduation_factor <= 1.0) return "graduation_factor must exceed 1";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (min_inlier_share < 0.0 || min_inlier_share > 1.0) {
    return "min_inlier_share must lie between 0 and 1";
  }
  if (max_standard_deviation <= 0.0) {
    return "max_standard_deviation must be positive";
  }
  return "";
}

// One call of Estimate: its motion so far and what it will return.
class Estimator::Solve {
 public:
  Solve(const EstimatorOptions& options, const std::vector<RobustCost>& costs,
        const Correspondences& correspondences, const Rigid3d& guess)
      : options_(options), costs_(costs), norms_(costs.size()) {
    estimate_.cur_from_prev = guess;
    estimate_.weights.assign(correspondences.size(), 0.0);
    estimate_.is_inlier.assign(correspondences.size(), false);
    rejected_ = correspondences.rejected();
    std::vector<bool> used(correspondences.size(), false);
    for (const RobustCost& term : costs_) {
      term.cost->Bind(correspondences, guess);
      for (const int match : term.cost->matches()) used[match] = true;
    }
    estimate_.num_used =
        static_cast<int>(std::count(used.begin(), used.end(), true));
  }

  MotionEstimate Run() {
    if (estimate_.num_used < kMinMatches) {
      estimate_.status = EstimateStatus::kTooFewMatches;
      estimate_.reason =
          std::to_string(estimate_.num_used) + " usable matches, 3 are needed";
      if (rejected_ > 0) {
        estimate_.reason +=
            "; " + std::to_string(rejected_) + " rejected as not finite";
      }
      return std::move(estimate_);
    }
    MakeLosses(1.0);
    estimate_.initial_cost = Linearise().cost;
    const bool usable = Minimise();
    Finish(usable);
    return std::move(estimate_);
  }

 private:
  void MakeLosses(double scale) {
    losses_.clear();
    for (const RobustCost& term : costs_) {
      losses_.push_back(term.loss ? term.loss(scale) : nullptr);
    }
  }

  MotionDerivatives MotionNow() const {
    return MotionOrigin(estimate_.cur_from_prev)
        .DerivativesAt(MotionVector::Zero().eval().data());
  }

  NormalEquations Linearise() const {
    const MotionDerivatives motion = MotionNow();
    NormalEquations sum;
    for (size_t i = 0; i < costs_.size(); ++i) {
      costs_[i].cost->Linearise(motion, losses_[i].get(), &sum);
    }
    return sum;
  }

  // Squared norms of all blocks at the motion so far; returns their robust
  // spread in units of the noise model, which is 1 for right matches.
  double UpdateNorms() {
    const MotionDerivatives motion = MotionNow();
    std::vector<double> ratios;
    for (size_t i = 0; i < costs_.size(); ++i) {
      const Cost& cost = *costs_[i].cost;
      cost.SquaredNorms(motion, &norms_[i]);
      const double median = ChiSquaredMedian(cost.independent_rows());
      for (const double s : norms_[i]) ratios.push_back(s / median);
    }
    return std::sqrt(Median(&ratios));
  }

  // All stages. False if the solver found no finite step.
  bool Minimise() {
    const bool robust = std::any_of(
        costs_.begin(), costs_.end(),
        [](const RobustCost& term) { return term.loss != nullptr; });
    double scale = 1.0;
    if (options_.graduate && robust) scale = std::max(1.0, UpdateNorms());
    for (; scale > 1.0;
         scale = std::max(1.0, scale / options_.graduation_factor)) {
      MakeLosses(scale);
      if (!MinimiseStage(kIterationsPerEarlyStage)) return false;
    }
    MakeLosses(1.0);
    return MinimiseStage(options_.max_iterations);
  }

  bool MinimiseStage(int max_iterations) {
    const MotionOrigin origin(estimate_.cur_from_prev);
    MotionVector x = MotionVector::Zero();
    ceres::Problem::Options problem_options;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    ceres::Problem problem(problem_options);
    for (size_t i = 0; i < costs_.size(); ++i) {
      costs_[i].cost->AddTo(options_.assembly, origin, losses_[i].get(),
                            x.data(), &problem);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.logging_type = ceres::SILENT;
    solver.num_threads = 1;
    solver.max_num_iterations = max_iterations;
    solver.function_tolerance = 1e-9;
    solver.parameter_tolerance = 1e-9;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    estimate_.iterations += static_cast<int>(summary.iterations.size()) - 1;
    converged_ = summary.termination_type == ceres::CONVERGENCE;
    if (!summary.IsSolutionUsable() || !x.allFinite()) return false;
    estimate_.cur_from_prev = origin.CurFromPrev(x.data());
    return true;
  }

  void Finish(bool usable) {
    if (!usable) {
      estimate_.status = EstimateStatus::kNotConverged;
      estimate_.reason = "the solver found no usable step";
      return;
    }
    estimate_.sigma = UpdateNorms();
    const double spread = JudgeMatches();
    const NormalEquations sum = Linearise();
    estimate_.final_cost = sum.cost;
    const Degeneracy degeneracy = FindDegeneracy(
        sum.hessian, total_weight_, options_.max_standard_deviation);
    if (degeneracy.is_degenerate) {
      estimate_.status = EstimateStatus::kDegenerate;
      estimate_.reason = degeneracy.reason;
      return;
    }
    estimate_.covariance = spread * degeneracy.inverse;
    const double share =
        static_cast<double>(estimate_.num_inliers) / estimate_.num_used;
    if (share < options_.min_inlier_share) {
      estimate_.status = EstimateStatus::kInconsistent;
      estimate_.reason = "only " + std::to_string(estimate_.num_inliers) +
                         " of " + std::to_string(estimate_.num_used) +
                         " matches agree with one motion";
    } else if (!converged_) {
      estimate_.status = EstimateStatus::kNotConverged;
      estimate_.reason = "stopped after " +
                         std::to_string(estimate_.iterations) + " iterations";
    } else {
      estimate_.status = EstimateStatus::kOk;
    }
  }

  // Fills weights and inliers from the norms. Returns the factor from the
  // inverse of the weighted Hessian to the covariance: Huber's (Robust
  // Statistics, 7.6) for residuals of p independent components,
  //   (sum w^2 s) (sum w p) / (sum (w p + 2 s w'))^2,  w = rho', w' = rho'',
  // times the correction for the six parameters fitted.
  double JudgeMatches() {
    double psi2 = 0.0, weight_p = 0.0, slope = 0.0;
    total_weight_ = 0.0;
    std::vector<bool> counted(estimate_.weights.size(), false);
    for (size_t i = 0; i < costs_.size(); ++i) {
      const Cost& cost = *costs_[i].cost;
      const int p = cost.independent_rows();
      const double limit = ChiSquared99(p);
      for (size_t k = 0; k < norms_[i].size(); ++k) {
        const double s = norms_[i][k];
        const LossValue loss(losses_[i].get(), s);
        psi2 += loss.rho[1] * loss.rho[1] * s;
        weight_p += loss.rho[1] * p;
        slope += loss.rho[1] * p + 2.0 * s * loss.rho[2];
        total_weight_ += loss.rho[1];
        // A match that several costs use is an inlier if all of them agree.
        const int match = cost.matches()[k];
        const bool agrees = s <= limit;
        estimate_.is_inlier[match] =
            agrees && (!counted[match] || estimate_.is_inlier[match]);
        estimate_.weights[match] =
            counted[match] ? std::min(estimate_.weights[match], loss.rho[1])
                           : loss.rho[1];
        counted[match] = true;
      }
    }
    estimate_.num_inliers = static_cast<int>(std::count(
        estimate_.is_inlier.begin(), estimate_.is_inlier.end(), true));
    // The slope can vanish for redescending losses among many outliers; a
    // fifth of the weight keeps the covariance finite and pessimistic.
    slope = std::max(slope, 0.2 * weight_p);
    const double fitted = weight_p > 6.0 ? weight_p / (weight_p - 6.0) : 1.0;
    return slope > 0.0 ? psi2 * weight_p / (slope * slope) * fitted : 0.0;
  }

  const EstimatorOptions& options_;
  const std::vector<RobustCost>& costs_;
  MotionEstimate estimate_;
  size_t rejected_ = 0;
  std::vector<std::unique_ptr<ceres::LossFunction>> losses_;
  std::vector<std::vector<double>> norms_;
  double total_weight_ = 0.0;
  bool converged_ = false;
};

Estimator::Estimator(const EstimatorOptions& options,
                     std::vector<RobustCost> costs)
    : options_(options), costs_(std::move(costs)) {}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

MotionEstimate Estimator::Estimate(const Correspondences& correspondences,
                                   const Rigid3d& guess) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  MotionEstimate estimate =
      Solve(options_, costs_, correspondences, guess).Run();
  estimate.solve_ms =
      std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return estimate;
}

const char* ToString(EstimateStatus status) {
  switch (status) {
    case EstimateStatus::kOk:
      return "ok";
    case EstimateStatus::kTooFewMatches:
      return "too_few_matches";
    case EstimateStatus::kDegenerate:
      return "degenerate";
    case EstimateStatus::kNotConverged:
      return "not_converged";
    case EstimateStatus::kInconsistent:
      return "inconsistent";
  }
  return "unknown";
}

}  // namespace rgbd_pose
