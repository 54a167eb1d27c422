#include "costs/direct_cost_factory.h"

#include <algorithm>
#include <utility>

#include "core/util/input_error.h"
#include "costs/cost_factory.h"
#include "costs/cost_list.h"
#include "costs/direct/direct_cost.h"
#include "robust/scale.h"

namespace rgbd_pose {

std::string DirectOptions::Check() const {
  if (max_points < 0) return "max_points must not be negative";
  if (!(min_gradient >= 0.0)) return "min_gradient must not be negative";
  if (!(min_depth > 0.0 && min_depth < max_depth && max_depth <= 1000.0)) {
    return "depth limits must satisfy 0 < min_depth < max_depth <= 1000 m";
  }
  // Points are kept for each level; images have far fewer.
  constexpr int kMaxLevels = 16;
  if (num_levels < 1 || num_levels > kMaxLevels || finest_level < 0) {
    return "num_levels must be 1 to 16 and finest_level not negative";
  }
  if (!(information_factor >= 0.0 && information_factor <= 1.0)) {
    return "information_factor must be 0 to 1";
  }
  return "";
}

EstimatorOptions DirectEstimatorOptions() {
  EstimatorOptions options;
  // The pyramid and a wide initial scale widen the basin.
  options.schedule = RobustSchedule::kDirect;
  options.scale = MadScale;
  // More rounds do not make scale and motion more accurate.
  options.max_scale_rounds = 1;
  options.max_iterations = 8;
  // 0.02 px of a half-size image with a focal length of 260 px.
  options.step_tolerance = 8e-5;
  options.max_scale = 5.0;
  options.max_standard_deviation = 0.05;
  return options;
}

Estimator MakeCoarseEstimator(const DirectOptions& options) {
  DirectOptions points = options;
  points.max_points = 300;
  points.finest_level = 3;  // 80 x 60 for 640 x 480
  points.num_levels = 3;
  EstimatorOptions estimator = DirectEstimatorOptions();
  estimator.scale = nullptr;
  // 0.025 px of the finest of these images with a focal length of 66 px.
  estimator.step_tolerance = 4e-4;
  // If fewer points agree, the estimate is wrong (docs/direct.md). 99 % of the
  // right estimates of real pairs had at least 0.69.
  estimator.min_inlier_share = 0.7;
  return Estimator(estimator,
                   MakeDirectCosts("photometric+inverse_depth+motion_prior",
                                   "huber,huber,none", points));
}

std::vector<RobustCost> JoinCosts(std::vector<RobustCost> matches,
                                  std::vector<RobustCost> pixels) {
  for (RobustCost& term : pixels) {
    const bool has_it = std::any_of(
        matches.begin(), matches.end(), [&](const RobustCost& other) {
          return other.cost->name() == term.cost->name();
        });
    if (!has_it) matches.push_back(std::move(term));
  }
  return matches;
}

std::vector<std::string> DirectCostNames() {
  return NamesOfTypes(DirectResidualTypes());
}

std::unique_ptr<MotionCost> MakeDirectCost(std::string_view name,
                                           const DirectOptions& options) {
  RequireSound(options.Check(), "direct cost: ");
  return MakeNamed<DirectCostOf>(DirectResidualTypes(), name, options);
}

std::vector<RobustCost> MakeDirectCosts(const std::string& cost_names,
                                        const std::string& loss_names,
                                        const DirectOptions& options) {
  std::vector<std::string> names = DirectCostNames();
  names.emplace_back(MotionPriorCost::kName);
  const auto make = [&](const std::string& name) {
    if (name == MotionPriorCost::kName) return MakeCost(name);
    return MakeDirectCost(name, options);
  };
  return MakeRobustCosts(cost_names, loss_names, names, make);
}

}  // namespace rgbd_pose
