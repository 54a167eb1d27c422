#include "core/estimation/robust_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/chi_squared.h"
#include "core/util/counter_random.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// Fewer residuals do not determine their spread.
constexpr size_t kMinResidualsForScale = 10;
// This many determine it to 2 %. If there are more (pixels), one block out of
// every two, three, ... is drawn at random, since a fixed step could coincide
// with a pattern (the rows of a block, the columns of an image).
constexpr size_t kMaxResidualsForScale = 2000;

// Limits of a scale: a spread of zero (over half of the residuals equal) or a
// huge one (over half of the matches wrong) is useless.
constexpr double kMinScale = 0.05;
constexpr double kMaxScale = 20.0;
// Scale and motion are estimated alternately until no scale changes by more.
constexpr double kScaleTolerance = 0.01;

}  // namespace

RobustProblem::RobustProblem(std::vector<RobustCost> costs)
    : costs_(std::move(costs)), norms_(costs_.size()) {
  ResetScales();
}

bool RobustProblem::has_losses() const {
  return std::any_of(costs_.begin(), costs_.end(), [](const RobustCost& term) {
    return term.loss != nullptr;
  });
}

int RobustProblem::num_levels() const {
  int most = 1;
  for (const RobustCost& term : costs_) {
    most = std::max(most, term.cost->num_levels());
  }
  return most;
}

void RobustProblem::Bind(const FramePair& pair, const Rigid3d& cur_from_prev) {
  num_matches_ = pair.matches != nullptr ? pair.matches->size() : 0;
  ResetScales();
  for (const RobustCost& term : costs_) term.cost->Bind(pair);
  Associate(AssociationPolicy::kOnce, cur_from_prev);
  SetLosses(1.0);
}

void RobustProblem::SetLevel(int level, const Rigid3d& cur_from_prev) {
  for (const RobustCost& term : costs_) {
    term.cost->SetLevel(std::min(level, term.cost->num_levels() - 1));
  }
  Associate(AssociationPolicy::kOnce, cur_from_prev);
}

bool RobustProblem::AsksFor(AssociationPolicy least) const {
  return std::any_of(costs_.begin(), costs_.end(), [=](const auto& term) {
    return term.cost->association() >= least;
  });
}

bool RobustProblem::Associate(AssociationPolicy least,
                              const Rigid3d& cur_from_prev) {
  if (!AsksFor(least)) return false;
  for (const RobustCost& term : costs_) {
    if (term.cost->association() >= least) term.cost->Associate(cur_from_prev);
  }
  CountMatches();
  return true;
}

void RobustProblem::Reassociate(const Rigid3d& cur_from_prev) {
  for (const RobustCost& term : costs_) {
    if (term.cost->association() == AssociationPolicy::kEveryStep) {
      term.cost->Reassociate(cur_from_prev);
    }
  }
  CountMatches();
}

void RobustProblem::CountMatches() {
  num_used_ = 0;
  counted_.assign(num_matches_, false);
  for (const RobustCost& term : costs_) {
    if (!HasScale(*term.cost)) continue;
    for (const int match : term.cost->matches()) {
      if (match >= 0 && counted_[match]) continue;
      if (match >= 0) counted_[match] = true;
      ++num_used_;
    }
  }
}

void RobustProblem::SetLosses(double width) {
  losses_.clear();
  for (size_t i = 0; i < costs_.size(); ++i) {
    losses_.emplace_back(costs_[i].loss.get(), scales_[i] * width, Factor(i));
  }
}

void RobustProblem::AddTo(Assembly assembly, const LinearizationPoint& origin,
                          double* x, ceres::Problem* problem) {
  for (size_t i = 0; i < costs_.size(); ++i) {
    ceres::LossFunction* const loss = Loss(i) ? &losses_[i] : nullptr;
    costs_[i].cost->AddTo(assembly, origin, loss, x, problem);
  }
}

NormalEquations RobustProblem::Linearise(const MotionDerivatives& motion,
                                         bool with_losses) const {
  NormalEquations sum;
  for (size_t i = 0; i < costs_.size(); ++i) {
    costs_[i].cost->Linearise(motion, with_losses ? Loss(i) : nullptr, &sum);
  }
  return sum;
}

double RobustProblem::UpdateNorms(const MotionDerivatives& motion) {
  values_.clear();
  for (size_t i = 0; i < costs_.size(); ++i) {
    const MotionCost& cost = *costs_[i].cost;
    cost.SquaredNorms(motion, &norms_[i]);
    if (!HasScale(cost)) continue;
    const double scale2 = scales_[i] * scales_[i];
    for (size_t k = 0; k < norms_[i].size(); ++k) {
      const double median = ChiSquaredMedian(cost.degrees()[k]);
      values_.push_back(norms_[i][k] / (scale2 * median));
    }
  }
  if (values_.empty()) return 0.0;
  return std::sqrt(UpperMedian(&values_));
}

bool RobustProblem::UpdateScales(
    const MotionDerivatives& motion,
    double (*scale)(std::vector<double>* residuals)) {
  bool has_changed = false;
  new_scales_.assign(costs_.size(), 1.0);
  for (size_t i = 0; i < costs_.size(); ++i) {
    if (!HasScale(*costs_[i].cost)) continue;
    const int group = costs_[i].cost->scale_group();
    size_t first = 0;
    while (costs_[first].cost->scale_group() != group) ++first;
    new_scales_[i] =
        first < i ? new_scales_[first] : EstimateScale(group, motion, scale);
    const double change = std::abs(new_scales_[i] - scales_[i]);
    if (change > kScaleTolerance * scales_[i]) has_changed = true;
  }
  if (has_changed) scales_ = new_scales_;
  return has_changed;
}

double RobustProblem::scale() const {
  double largest = 0.0;
  for (size_t i = 0; i < costs_.size(); ++i) {
    if (HasScale(*costs_[i].cost)) largest = std::max(largest, scales_[i]);
  }
  return largest;
}

double RobustProblem::EstimateScale(
    int group, const MotionDerivatives& motion,
    double (*scale)(std::vector<double>* residuals)) {
  values_.clear();
  for (const RobustCost& term : costs_) {
    if (term.cost->scale_group() != group) continue;
    term.cost->Residuals(motion, &residuals_);
    // Redundant rows are smaller by the root of their redundancy.
    const int rows = term.cost->num_residuals();
    const int degrees = term.cost->degrees_of_freedom();
    const double unit = std::sqrt(static_cast<double>(rows) / degrees);
    const size_t blocks = residuals_.size() / rows;
    const size_t asked = std::min(blocks, kMaxResidualsForScale / rows);
    CounterRandom random(1);
    for (size_t k = 0; k < asked; ++k) {
      const size_t first = k * blocks / asked, end = (k + 1) * blocks / asked;
      const size_t i = first + random.Below(static_cast<uint32_t>(end - first));
      // Missing measurements of a match leave rows of zeros.
      if (term.cost->degrees()[i] < degrees) continue;
      for (int row = 0; row < rows; ++row) {
        values_.push_back(unit * residuals_[i * rows + row]);
      }
    }
  }
  if (values_.size() < kMinResidualsForScale) return 1.0;
  return std::clamp(scale(&values_), kMinScale, kMaxScale);
}

}  // namespace rgbd_pose
