#include "core/estimation/estimator.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/estimation/covariance_accumulator.h"
#include "core/estimation/degeneracy.h"
#include "core/estimation/hidden_errors.h"
#include "core/estimation/minimiser.h"
#include "core/util/input_error.h"
#include "core/util/stage_timer.h"

namespace rgbd_pose {
namespace {

// Above this share of inliers, the outliers are few or just large noise.
constexpr double kHardlyWrong = 0.95;

// Chi^2 of six degrees of freedom that is as rare as five sigmas.
constexpr double kFiveSigmas = 40.9;
// The same, exceeded by chance once in two hundred.
constexpr double kOneInTwoHundred = 18.5;

std::vector<RobustCost> TermsOf(std::unique_ptr<MotionCost> cost,
                                std::unique_ptr<ceres::LossFunction> loss) {
  std::vector<RobustCost> terms;
  terms.push_back({std::move(cost), std::move(loss)});
  return terms;
}

// Whether most points are beyond the range of any RGB-D camera.
bool AreFarAway(const std::vector<CameraMatches>& cameras) {
  constexpr double kFarthest = 100.0;  // m
  size_t all = 0, far = 0;
  for (const CameraMatches& camera : cameras) {
    all += camera.matches->size();
    far += std::count_if(
        camera.matches->begin(), camera.matches->end(),
        [](const Match& match) { return match.prev.depth > kFarthest; });
  }
  return 2 * far > all;
}

}  // namespace

std::string EstimatorOptions::Check() const {
  // Each condition is written to reject NaN.
  if (!(gnc_factor >= 1.01)) return "gnc_factor must be at least 1.01";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (!(min_inlier_share >= 0.0 && min_inlier_share <= 1.0)) {
    return "min_inlier_share must lie between 0 and 1";
  }
  if (!(max_false_alarms > 0.0)) return "max_false_alarms must be positive";
  if (!(max_scale > 0.0)) return "max_scale must be positive";
  if (max_scale_rounds < 0) return "max_scale_rounds must not be negative";
  if (threads < 1) return "threads must be at least 1";
  if (!(step_tolerance > 0.0)) return "step_tolerance must be positive";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  return "";
}

// The implementation of Estimate and its memory.
class Estimator::Impl {
 public:
  Impl(const EstimatorOptions& options, std::vector<RobustCost> costs)
      : options_(options),
        terms_(std::move(costs)),
        minimiser_(options_, &terms_) {
    RequireSound(options.Check(), "estimator: ");
  }

  void Run(const FramePair* pairs, size_t num_pairs, const Rigid3d& guess,
           MotionEstimate* estimate) {
    const bool is_finite = guess.IsFinite();
    pairs_.assign(pairs, pairs + num_pairs);
    Reset(is_finite ? guess : Rigid3d(), estimate);
    if (!is_finite) {
      out_->status = EstimateStatus::kNotConverged;
      out_->reason = "the guess is not finite";
      return;
    }
    if (terms_.num_used() < kMinMatches) {
      out_->status = EstimateStatus::kTooFewMatches;
      out_->reason =
          std::to_string(out_->num_used) + " usable matches, 3 are needed";
      size_t rejected = 0;
      for (const CameraMatches& camera : terms_.cameras()) {
        rejected += camera.matches->rejected();
      }
      if (rejected > 0) {
        out_->reason += "; " + std::to_string(rejected) +
                        " rejected as not finite or out of range";
      }
      return;
    }
    const bool is_found = minimiser_.Run(guess, pairs_.front().num_levels);
    out_->iterations = minimiser_.iterations();
    if (is_found) {
      out_->cur_from_prev = minimiser_.motion();
      Judge(guess);
    } else {
      JudgeGuess(guess);
    }
    if (!out_->ok() && AreFarAway(terms_.cameras())) {
      out_->reason += "; most depths exceed 100 m; are they in millimetres?";
    }
    out_->num_used = terms_.num_used();
  }

 private:
  void Reset(const Rigid3d& guess, MotionEstimate* estimate) {
    for (FramePair& pair : pairs_) pair.threads = options_.threads;
    terms_.Bind(pairs_, guess);
    const size_t num_matches = terms_.num_matches();
    out_ = estimate;
    out_->reason.clear();
    out_->cur_from_prev = guess;
    out_->covariance.setZero();
    out_->weights.assign(num_matches, 0.0);
    out_->is_inlier.assign(num_matches, false);
    out_->residual_norms.assign(num_matches, 0.0);
    out_->residual_degrees.assign(num_matches, 0);
    out_->num_inliers = out_->iterations = 0;
    out_->sigma = out_->initial_cost = out_->final_cost = 0.0;
    out_->num_used = terms_.num_used();
  }

  // If nothing was found, the matches at the guess, all inliers, may show why.
  void JudgeGuess(const Rigid3d& guess) {
    terms_.SetLevel(0, guess);
    const NormalEquations sum =
        terms_.Linearise(DerivativesAt(guess), /*with_losses=*/false);
    out_->status = EstimateStatus::kDegenerate;
    out_->reason =
        FindDegeneracy(sum.hessian, SpuriousInformation(terms_.cameras(), {}),
                       options_.max_standard_deviation)
            .reason;
    if (!out_->reason.empty()) return;
    out_->status = EstimateStatus::kNotConverged;
    out_->reason = "the solver found no usable step";
  }

  void Judge(const Rigid3d& guess) {
    const MotionDerivatives motion = DerivativesAt(out_->cur_from_prev);
    out_->sigma = terms_.UpdateNorms(motion) * terms_.scale();
    out_->initial_cost = terms_.Linearise(DerivativesAt(guess)).cost;
    const NormalEquations as_solved = shares_.Linearise(terms_, motion);
    out_->final_cost = as_solved.cost;
    const bool is_flattened = terms_.FlattenLosses();
    shares_.JudgeMatches(terms_, out_);
    const NormalEquations sum =
        is_flattened ? shares_.Linearise(terms_, motion) : as_solved;
    const double spurious =
        SpuriousInformation(terms_.cameras(), out_->weights);
    Degeneracy degeneracy =
        FindDegeneracy(sum.hessian, spurious, options_.max_standard_deviation);
    if (!degeneracy.is_degenerate() &&
        out_->num_inliers < kHardlyWrong * terms_.num_used()) {
      const double by_pixels =
          shares_.KnownByPixels(terms_, degeneracy.weakest_rotation);
      JudgeWeakestRotation(terms_.cameras(), *out_, by_pixels, spurious,
                           options_.max_standard_deviation, &degeneracy);
    }
    if (degeneracy.is_degenerate()) {
      out_->status = EstimateStatus::kDegenerate;
      out_->reason = degeneracy.reason;
      return;
    }
    out_->covariance = shares_.Covariance(terms_, motion, degeneracy.inverse);
    out_->reason = Contradiction(degeneracy.inverse);
    if (!out_->reason.empty()) {
      out_->status = EstimateStatus::kInconsistent;
    } else if (!minimiser_.converged()) {
      out_->status = EstimateStatus::kNotConverged;
      out_->reason =
          "stopped after " + std::to_string(out_->iterations) + " iterations";
    } else {
      out_->status = EstimateStatus::kOk;
    }
    out_->covariance += HiddenErrors(terms_, out_->cur_from_prev,
                                     degeneracy.inverse, out_->covariance);
  }

  // What speaks against the motion, or empty. `inverse`: of the Hessian.
  std::string Contradiction(const MotionMatrix& inverse) {
    const int used = terms_.num_used();
    const double share = static_cast<double>(out_->num_inliers) / used;
    const auto agreeing = [&] {
      return std::to_string(out_->num_inliers) + " of " + std::to_string(used) +
             " matches agree with one motion";
    };
    if (terms_.scale() > options_.max_scale) {
      return "residuals are " + std::to_string(terms_.scale()) +
             " times as large as the noise model predicts";
    }
    if (share < options_.min_inlier_share) return "only " + agreeing();
    if (shares_.FalseAlarmsOf(terms_, inverse,
                              options_.max_standard_deviation) >
        options_.max_false_alarms) {
      return agreeing() + ", as many as wrong ones may by chance";
    }
    if (shares_.PullOfOutliers(terms_, out_->cur_from_prev, out_->covariance) >
        kOneInTwoHundred) {
      return "matches that disagree pull the motion away from the others; a "
             "loss such as tukey leaves them out";
    }
    if (shares_.PriorChiSquared(out_->covariance) > kFiveSigmas) {
      return "inconsistent with the prior";
    }
    return "";
  }

  const EstimatorOptions options_;
  RobustProblem terms_;
  Minimiser minimiser_;
  CovarianceAccumulator shares_;

  // State of the current call.
  std::vector<FramePair> pairs_;
  MotionEstimate* out_ = nullptr;
};

Estimator::Estimator(const EstimatorOptions& options,
                     std::vector<RobustCost> costs)
    : impl_(std::make_unique<Impl>(options, std::move(costs))) {}

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

void Estimator::Estimate(const FramePair& pair, const Rigid3d& guess,
                         MotionEstimate* estimate) {
  estimate->solve_ms = 0.0;
  const StageTimer timer(&estimate->solve_ms);
  impl_->Run(&pair, 1, guess, estimate);
}

void Estimator::Estimate(const std::vector<FramePair>& pairs,
                         const Rigid3d& guess, MotionEstimate* estimate) {
  estimate->solve_ms = 0.0;
  const StageTimer timer(&estimate->solve_ms);
  impl_->Run(pairs.data(), pairs.size(), guess, estimate);
}

}  // namespace rgbd_pose
