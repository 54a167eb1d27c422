#include "frontend/calibration/calibration_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/factors/blocks.h"
#include "costs/calibration/landmark_factors.h"
#include "frontend/calibration/calibration_halves.h"

namespace rgbd_pose {
namespace {

// Returns the robust cost of a view of the i-th landmark and its error (px).
double CostOf(const CalibrationViews& views, const LandmarkView& view,
              bool with_depth, const CalibrationState& state,
              const std::vector<PoseOf<double>>& poses, size_t i,
              const CalibrationState& scales, Eigen::Vector2d* error) {
  const Landmark& landmark = views.landmarks[i];
  const Eigen::Matrix<double, 1, 1> d(state.inverse_depths[i]);
  const auto model = ModelOf(views);
  const LandmarkData data = DataOf(views, landmark, view, scales);
  const PoseOf<double>& anchor = poses[landmark.anchor];
  const PoseOf<double>& there = poses[view.keyframe];
  const double square = kLandmarkLossWidth * kLandmarkLossWidth;
  LandmarkPixelFactor{model, data}.Residual(anchor, there, d, state.theta,
                                            error->data());
  double cost = square * std::log1p(error->squaredNorm() / square);
  *error /= data.inverse_sigma_px;
  if (with_depth) {
    double r;
    LandmarkDepthFactor{model, data}.Residual(anchor, there, d, state.theta,
                                              &r);
    cost += square * std::log1p(r * r / square);
  }
  return 0.5 * cost;
}

// The motion (px/s) in the image of the i-th landmark in a view.
Eigen::Vector2d FlowOf(const CalibrationViews& views, const LandmarkView& view,
                       const CalibrationState& state,
                       const std::vector<PoseOf<double>>& poses, size_t i) {
  const Landmark& landmark = views.landmarks[i];
  const double d = state.inverse_depths[i];
  const double* const theta = state.theta.data();
  const Eigen::Vector3d X = InView(CalibratedLens<double>(theta, views.camera),
                                   poses[landmark.anchor], poses[view.keyframe],
                                   d, DataOf(views, landmark, view, state)) /
                            d;
  Eigen::Vector3d v;
  views.twists[view.keyframe].PointVelocity(X.data(), v.data());
  return {theta[kFx] * (v.x() - X.x() / X.z() * v.z()) / X.z(),
          theta[kFy] * (v.y() - X.y() / X.z() * v.z()) / X.z()};
}

// The summed costs of some views under two solutions.
struct CostPair {
  double before = 0.0, after = 0.0;
  int views = 0;

  void Add(const CostPair& other) {
    before += other.before;
    after += other.after;
    views += other.views;
  }
  double Gain() const { return (before - after) / views; }
};

// The costs of pairs of keyframes, in order of time.
using PairCosts = std::map<std::pair<int, int>, CostPair>;

// Sums up the costs of held-out views or, with training_too, of all views. Both
// sets of views differ only in their depths. The residuals are those of the
// views that were summed up.
PairCosts CostsOfPairs(const CalibrationViews& views_before,
                       const CalibrationState& before,
                       const CalibrationViews& views_after,
                       const CalibrationState& after, bool training_too,
                       std::vector<HeldOutResidual>* residuals) {
  PairCosts pairs;
  const auto poses_before = PosesOf(before), poses_after = PosesOf(after);
  residuals->clear();
  for (size_t i = 0; i < views_before.landmarks.size(); ++i) {
    const Landmark& landmark = views_before.landmarks[i];
    const auto begin = views_before.views.begin() + landmark.first_view;
    const auto end = begin + landmark.num_views;
    const bool has_trained = std::any_of(
        begin, end, [](const LandmarkView& view) { return !view.is_held_out; });
    // Other landmarks are placed only by their own depth.
    if (!training_too && !has_trained) continue;
    for (auto view = begin; view != end; ++view) {
      if (!training_too && !view->is_held_out) continue;
      const LandmarkView& view_after =
          views_after.views[view - views_before.views.begin()];
      const bool with_depth = view->depth.inverse_sigma > 0.0 &&
                              view_after.depth.inverse_sigma > 0.0;
      HeldOutResidual residual = {view->u, view->v, {}, {}, {}};
      residual.flow = FlowOf(views_after, view_after, after, poses_after, i);
      CostPair cost;
      cost.before = CostOf(views_before, *view, with_depth, before,
                           poses_before, i, after, &residual.before);
      cost.after = CostOf(views_after, view_after, with_depth, after,
                          poses_after, i, after, &residual.after);
      cost.views = 1;
      pairs[std::minmax(landmark.anchor, view->keyframe)].Add(cost);
      residuals->push_back(residual);
    }
  }
  return pairs;
}

// The mean gain in its standard errors, from samples that err independently; 0
// if they are too few or do not differ.
double InStandardErrors(const std::vector<double>& gains) {
  const double n = static_cast<double>(gains.size());
  if (n < 2.0) return 0.0;
  double sum = 0.0, squares = 0.0;
  for (const double gain : gains) sum += gain;
  const double mean = sum / n;
  for (const double gain : gains) squares += (gain - mean) * (gain - mean);
  const double variance = squares / (n - 1.0);
  return variance > 0.0 ? mean / std::sqrt(variance / n) : 0.0;
}

}  // namespace

void CompareHeldOut(const CalibrationViews& views_before,
                    const CalibrationState& before,
                    const CalibrationViews& views_after,
                    const CalibrationState& after, CalibrationResult* result) {
  const PairCosts pairs =
      CostsOfPairs(views_before, before, views_after, after,
                   /*training_too=*/false, &result->residuals);
  std::vector<double> gains;
  CostPair all;
  for (const auto& [keyframes, pair] : pairs) {
    gains.push_back(pair.Gain());
    all.Add(pair);
  }
  result->held_out_pairs = static_cast<int>(pairs.size());
  if (pairs.size() < 2) return;
  result->cost_before = all.before / all.views;
  result->cost_after = all.after / all.views;
  result->gain_sigmas = InStandardErrors(gains);
}

void CompareOnUnseen(const CalibrationViews& views_before,
                     const CalibrationState& before,
                     const CalibrationViews& views_after,
                     const CalibrationState& after, const FreeParts& is_free,
                     const CalibrationPrior& prior,
                     const std::function<void()>& on_iteration,
                     CalibrationResult* result) {
  std::array<CalibrationHalf, 2> old = HalvesOf(views_before, before);
  std::array<CalibrationHalf, 2> found = HalvesOf(views_after, after);
  const auto solve = [&](const FreeParts& parts, CalibrationHalf* half) {
    const BundleAdjustment problem(half->views, prior, false,
                                   BundleAdjustment::kMaxIterations,
                                   on_iteration);
    return std::isfinite(problem.Solve(parts, &half->state));
  };
  CalibrationVector theta[2];
  for (int k = 0; k < 2; ++k) {
    CalibrationHalf half = found[k];
    if (!solve(is_free, &half)) return;
    theta[k] = half.state.theta;
  }
  // Pairs of keyframes share views and moments, so they do not err
  // independently; parts of the recording nearly do.
  constexpr int kPartsOfHalf = 5;
  std::vector<double> gains;
  CostPair all;
  for (int k = 0; k < 2; ++k) {
    found[k].state.theta = theta[1 - k];
    if (!solve({}, &old[k]) || !solve({}, &found[k])) return;
    std::vector<HeldOutResidual> residuals;
    const PairCosts pairs =
        CostsOfPairs(old[k].views, old[k].state, found[k].views, found[k].state,
                     /*training_too=*/true, &residuals);
    const auto num_views = static_cast<int64_t>(residuals.size());
    CostPair parts[kPartsOfHalf];
    int64_t done = 0;
    for (const auto& [keyframes, pair] : pairs) {
      parts[kPartsOfHalf * done / num_views].Add(pair);
      all.Add(pair);
      done += pair.views;
    }
    for (const CostPair& part : parts) {
      if (part.views > 0) gains.push_back(part.Gain());
    }
  }
  if (all.views == 0) return;
  result->unseen_before = all.before / all.views;
  result->unseen_after = all.after / all.views;
  result->unseen_sigmas = InStandardErrors(gains);
}

double TruthError(const CalibrationData& data, const CalibrationState& state,
                  const Trajectory& truth) {
  double sum = 0.0;
  int count = 0;
  for (const auto& [a, b] : data.pairs) {
    const auto b_from_a =
        MotionAlong(truth, data.timestamps[a], data.timestamps[b]);
    if (!b_from_a.has_value()) continue;
    const Rigid3d found =
        state.world_from_cam[b].Inverse() * state.world_from_cam[a];
    sum += (b_from_a->Inverse() * found).translation.squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace rgbd_pose
