#include "core/estimation/robust_terms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/chi_squared.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// Fewer residuals say nothing about their spread.
constexpr size_t kMinResidualsForScale = 10;
// What a scale may come to: a spread of zero (over half of the residuals
// equal) or a huge one (over half of the matches wrong) has no use.
constexpr double kMinScale = 0.05;
constexpr double kMaxScale = 20.0;

}  // namespace

RobustTerms::RobustTerms(std::vector<RobustCost> costs)
    : costs_(std::move(costs)), norms_(costs_.size()) {}

bool RobustTerms::has_losses() const {
  return std::any_of(costs_.begin(), costs_.end(), [](const RobustCost& term) {
    return term.loss != nullptr;
  });
}

void RobustTerms::Bind(const CostInput& input) {
  for (const RobustCost& term : costs_) term.cost->Bind(input);
  CountMatches(input.matches.size());
  SetLosses(1.0);
}

bool RobustTerms::BindAgain(const CostInput& input) {
  bool changed = false;
  for (const RobustCost& term : costs_) {
    if (!term.cost->freezes_weights()) continue;
    term.cost->Bind(input);
    changed = true;
  }
  if (changed) CountMatches(input.matches.size());
  return changed;
}

void RobustTerms::CountMatches(size_t num_matches) {
  num_blocks_ = 0;
  counted_.assign(num_matches, false);
  for (const RobustCost& term : costs_) {
    for (const int match : term.cost->matches()) {
      if (match >= 0) counted_[match] = true;
    }
    num_blocks_ += static_cast<int>(term.cost->matches().size());
  }
  num_used_ =
      static_cast<int>(std::count(counted_.begin(), counted_.end(), true));
}

void RobustTerms::SetLosses(double scale) {
  losses_.clear();
  for (const RobustCost& term : costs_) {
    losses_.emplace_back(term.loss.get(), scale);
  }
}

void RobustTerms::AddTo(Assembly assembly, const MotionOrigin& origin,
                        double* x, ceres::Problem* problem) {
  for (size_t i = 0; i < costs_.size(); ++i) {
    ceres::LossFunction* const loss = costs_[i].loss ? &losses_[i] : nullptr;
    costs_[i].cost->AddTo(assembly, origin, loss, x, problem);
  }
}

NormalEquations RobustTerms::Linearise(const MotionDerivatives& motion) const {
  NormalEquations sum;
  for (size_t i = 0; i < costs_.size(); ++i) {
    costs_[i].cost->Linearise(motion, Loss(i), &sum);
  }
  return sum;
}

NormalEquations RobustTerms::LineariseWithoutLosses(
    const MotionDerivatives& motion) const {
  NormalEquations sum;
  for (const RobustCost& term : costs_) {
    term.cost->Linearise(motion, nullptr, &sum);
  }
  return sum;
}

double RobustTerms::UpdateNorms(const MotionDerivatives& motion) {
  values_.clear();
  for (size_t i = 0; i < costs_.size(); ++i) {
    const Cost& cost = *costs_[i].cost;
    cost.SquaredNorms(motion, &norms_[i]);
    for (size_t k = 0; k < norms_[i].size(); ++k) {
      values_.push_back(norms_[i][k] / ChiSquaredMedian(cost.degrees()[k]));
    }
  }
  if (values_.empty()) return 0.0;
  return std::sqrt(UpperMedian(&values_));
}

double RobustTerms::EstimateScale(
    const MotionDerivatives& motion,
    double (*scale)(std::vector<double>* residuals)) {
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
  return std::clamp(scale(&values_), kMinScale, kMaxScale);
}

LossSums RobustTerms::JudgeMatches(double scale, MotionEstimate* estimate) {
  LossSums sums;
  counted_.assign(estimate->weights.size(), false);
  for (size_t i = 0; i < costs_.size(); ++i) {
    const Cost& cost = *costs_[i].cost;
    for (size_t k = 0; k < norms_[i].size(); ++k) {
      const int p = cost.degrees()[k];
      const double limit =
          scale * scale *
          (cost.is_whitened() ? ChiSquared99(p) : cost.InlierLimit(k));
      const double s = norms_[i][k];
      double rho[3];
      losses_[i].Evaluate(s, rho);
      sums.Add(rho, s, p);
      const int match = cost.matches()[k];
      if (match < 0) continue;
      // Losses that are steeper than least squares near 0 weigh above 1.
      JudgeMatch(match, std::min(rho[1], 1.0), s <= limit, estimate);
      const double norm = std::sqrt(s);
      if (norm >= estimate->residual_norms[match]) {
        estimate->residual_norms[match] = norm;
        estimate->residual_degrees[match] = p;
      }
    }
  }
  estimate->num_inliers = static_cast<int>(
      std::count(estimate->is_inlier.begin(), estimate->is_inlier.end(), true));
  return sums;
}

// A match that several costs use is an inlier if all of them agree.
void RobustTerms::JudgeMatch(int match, double weight, bool agrees,
                             MotionEstimate* estimate) {
  const bool again = counted_[match];
  estimate->is_inlier[match] = agrees && (!again || estimate->is_inlier[match]);
  estimate->weights[match] =
      again ? std::min(estimate->weights[match], weight) : weight;
  counted_[match] = true;
}

MotionMatrix RobustTerms::Covariance(const MotionDerivatives& motion,
                                     const LossSums& sums,
                                     const MotionMatrix& inverse) {
  weighted_.clear();
  for (size_t i = 0; i < costs_.size(); ++i) {
    weighted_.push_back({costs_[i].cost.get(), Loss(i)});
  }
  return RobustCovariance(weighted_, motion, sums, inverse);
}

}  // namespace rgbd_pose
