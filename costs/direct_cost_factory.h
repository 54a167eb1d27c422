#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/estimation/motion_cost.h"
#include "costs/direct/direct_options.h"

namespace rgbd_pose {

// The names of all direct costs, in the order of the type list.
std::vector<std::string> DirectCostNames();

// The direct cost with that name, or null.
std::unique_ptr<MotionCost> MakeDirectCost(std::string_view name,
                                           const DirectOptions& options);

// The defaults.
inline constexpr char kDefaultDirectCost[] = "photometric+projective_plane";
inline constexpr char kDefaultDirectLoss[] = "tukey";
// Loss, with a wide basin, from the guess to where the default can judge.
inline constexpr char kLeadingLoss[] = "huber";

// Like MakeRobustCosts, for direct costs and motion_prior.
std::vector<RobustCost> MakeDirectCosts(
    const std::string& cost_names = kDefaultDirectCost,
    const std::string& loss_names = kLeadingLoss,
    const DirectOptions& options = {});

// Costs on matches and on pixels in one sum; a cost that is in both (the prior)
// is taken once.
std::vector<RobustCost> JoinCosts(std::vector<RobustCost> matches,
                                  std::vector<RobustCost> pixels);

// Estimator options for direct costs.
EstimatorOptions DirectEstimatorOptions();

// An estimator that leads from a distant guess to where finer images or matches
// continue, with images of 80 x 60 pixels and smaller. Ignores max_points,
// finest_level and num_levels of `options`.
Estimator MakeCoarseEstimator(const DirectOptions& options = {});

}  // namespace rgbd_pose
