#include "core/estimation/robust_problem.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/util/counter_random.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// Fewer independent residuals do not determine their spread: six of them are
// fitted, which makes the others small, too.
constexpr int kMinResidualsForScale = 30;
// This many determine it to 2 %. If there are more (pixels), one block out of
// every two, three, ... is drawn at random: a fixed step could meet a pattern.
constexpr size_t kMaxResidualsForScale = 2000;

// A spread of zero (most residuals equal) or a huge one (most wrong) is no use.
constexpr double kMinScale = 0.05;
constexpr double kMaxScale = 20.0;
// Scale and motion are estimated alternately until no scale changes by more.
constexpr double kScaleTolerance = 0.01;

}  // namespace

RobustProblem::RobustProblem(std::vector<RobustCost> costs) {
  for (RobustCost& cost : costs) {
    if (cost.cost == nullptr) throw InputError("an estimator needs a cost");
    const CameraMounting mounting = cost.cost->mounting();
    for (const RobustTerm& term : terms_) {
      const CameraMounting other = term.cost->mounting();
      if (other.camera != mounting.camera ||
          other.body_from_cam == mounting.body_from_cam) {
        continue;
      }
      throw InputError("camera " + std::to_string(mounting.camera) +
                       " has costs with two different mountings");
    }
    terms_.push_back({std::move(cost)});
  }
}

void RobustProblem::Bind(const std::vector<FramePair>& pairs,
                         const Rigid3d& cur_from_prev) {
  static const Correspondences kNone;
  int num_cameras = 1;
  for (const RobustTerm& term : terms_) {
    num_cameras = std::max(num_cameras, term.cost->mounting().camera + 1);
  }
  if (pairs.size() != static_cast<size_t>(num_cameras)) {
    throw InputError("the costs need the pairs of " +
                     std::to_string(num_cameras) +
                     " camera(s), but the number of pairs is " +
                     std::to_string(pairs.size()));
  }
  num_matches_ = 0;
  cameras_.clear();
  for (const FramePair& pair : pairs) {
    const Correspondences* const matches =
        pair.matches != nullptr ? pair.matches : &kNone;
    cameras_.push_back({matches, num_matches_, Rigid3d()});
    num_matches_ += matches->size();
  }
  ResetScales();
  for (RobustTerm& term : terms_) {
    const CameraMounting mounting = term.cost->mounting();
    cameras_[mounting.camera].body_from_cam = mounting.body_from_cam;
    term.first_match = cameras_[mounting.camera].first;
    term.cost->Bind(pairs[mounting.camera]);
  }
  Associate(AssociationPolicy::kOnce, cur_from_prev);
  SetLosses(1.0);
}

void RobustProblem::SetLevel(int level, const Rigid3d& cur_from_prev) {
  for (const RobustTerm& term : terms_) {
    term.cost->SetLevel(std::min(level, term.cost->num_levels() - 1));
  }
  Associate(AssociationPolicy::kOnce, cur_from_prev);
}

bool RobustProblem::AsksFor(AssociationPolicy least) const {
  return std::any_of(terms_.begin(), terms_.end(), [=](const auto& term) {
    return term.cost->association() >= least;
  });
}

bool RobustProblem::Associate(AssociationPolicy least,
                              const Rigid3d& cur_from_prev) {
  if (!AsksFor(least)) return false;
  for (const RobustTerm& term : terms_) {
    if (term.cost->association() >= least) term.cost->Associate(cur_from_prev);
  }
  CountMatches();
  return true;
}

void RobustProblem::Reassociate(const Rigid3d& cur_from_prev) {
  for (const RobustTerm& term : terms_) {
    if (term.cost->association() == AssociationPolicy::kEveryStep) {
      term.cost->Reassociate(cur_from_prev);
    }
  }
  CountMatches();
}

void RobustProblem::CountMatches() {
  num_used_ = 0;
  counted_.assign(num_matches_, false);
  for (const RobustTerm& term : terms_) {
    if (!term.has_scale()) continue;
    for (const int match : term.cost->matches()) {
      if (match >= 0) {
        const size_t index = term.first_match + match;
        if (counted_[index]) continue;
        counted_[index] = true;
      }
      ++num_used_;
    }
  }
}

void RobustProblem::SetLosses(double width) {
  for (RobustTerm& term : terms_) {
    term.scaled =
        ScaledLoss(term.loss.get(), term.scale * width, term.factor());
  }
}

bool RobustProblem::FlattenLosses() {
  bool has_steep = false;
  for (RobustTerm& term : terms_) {
    if (!term.scaled.IsSteepAtZero()) continue;
    term.scaled.FlattenBelow(ChiSquaredMedian(term.cost->degrees_of_freedom()));
    has_steep = true;
  }
  return has_steep;
}

void RobustProblem::AddTo(Assembly assembly, const LinearizationPoint& origin,
                          double* x, ceres::Problem* problem) {
  for (RobustTerm& term : terms_) {
    ceres::LossFunction* const loss = term.is_plain() ? nullptr : &term.scaled;
    term.cost->AddTo(assembly, origin, loss, x, problem);
  }
}

NormalEquations RobustProblem::Linearise(const MotionDerivatives& motion,
                                         bool with_losses) const {
  NormalEquations sum;
  for (const RobustTerm& term : terms_) {
    term.cost->Linearise(motion, with_losses ? term.scaled_or_null() : nullptr,
                         &sum);
  }
  return sum;
}

double RobustProblem::UpdateNorms(const MotionDerivatives& motion) {
  values_.clear();
  for (RobustTerm& term : terms_) {
    term.cost->SquaredNorms(motion, &term.norms);
    if (!term.has_scale()) continue;
    const double scale2 = term.scale * term.scale;
    for (size_t k = 0; k < term.norms.size(); ++k) {
      const double median = ChiSquaredMedian(term.cost->degrees()[k]);
      values_.push_back(term.norms[k] / (scale2 * median));
    }
  }
  if (values_.empty()) return 0.0;
  return std::sqrt(UpperMedian(&values_));
}

bool RobustProblem::UpdateScales(
    const MotionDerivatives& motion,
    double (*scale)(std::vector<double>* residuals)) {
  bool has_changed = false;
  new_scales_.assign(terms_.size(), 1.0);
  for (size_t i = 0; i < terms_.size(); ++i) {
    if (!terms_[i].has_scale()) continue;
    const int group = terms_[i].cost->scale_group();
    size_t first = 0;
    while (terms_[first].cost->scale_group() != group) ++first;
    new_scales_[i] =
        first < i ? new_scales_[first] : EstimateScale(group, motion, scale);
    const double change = std::abs(new_scales_[i] - terms_[i].scale);
    if (change > kScaleTolerance * terms_[i].scale) has_changed = true;
  }
  for (size_t i = 0; has_changed && i < terms_.size(); ++i) {
    terms_[i].scale = new_scales_[i];
  }
  return has_changed;
}

double RobustProblem::scale() const {
  double largest = 0.0;
  for (const RobustTerm& term : terms_) {
    if (term.has_scale()) largest = std::max(largest, term.scale);
  }
  return largest;
}

double RobustProblem::EstimateScale(
    int group, const MotionDerivatives& motion,
    double (*scale)(std::vector<double>* residuals)) {
  values_.clear();
  int independent = 0;
  for (const RobustTerm& term : terms_) {
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
      independent += degrees;
      for (int row = 0; row < rows; ++row) {
        values_.push_back(unit * residuals_[i * rows + row]);
      }
    }
  }
  if (independent < kMinResidualsForScale) return 1.0;
  return std::clamp(scale(&values_), kMinScale, kMaxScale);
}

}  // namespace rgbd_pose
