#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/estimation/motion_cost.h"
#include "costs/direct/direct_cost.h"

namespace rgbd_pose {

// The names of all direct costs, in the order of the type list.
std::vector<std::string> DirectCostNames();

// The direct cost of that name, or null.
std::unique_ptr<MotionCost> MakeDirectCost(std::string_view name,
                                           const DirectOptions& options);

// What is taken where nobody says otherwise.
inline constexpr char kDefaultDirectCost[] = "photometric+projective_plane";
inline constexpr char kDefaultDirectLoss[] = "tukey";
// Of what leads from a guess to where that may judge: with a basin.
inline constexpr char kLeadingLoss[] = "huber";

// As MakeRobustCosts, of direct costs and motion_prior.
std::vector<RobustCost> MakeDirectCosts(
    const std::string& cost_names = kDefaultDirectCost,
    const std::string& loss_names = kLeadingLoss,
    const DirectOptions& options = {});

// Costs of matches and of pixels in one sum; a prior that both have counts
// once.
std::vector<RobustCost> JoinCosts(std::vector<RobustCost> matches,
                                  std::vector<RobustCost> pixels);

// How estimators minimise direct costs.
EstimatorOptions DirectEstimatorOptions();

// What leads from far away to where finer images or matches go on: images of
// 80 x 60 pixels and fewer, with the depths there, which keep it off what has
// come before the camera, and a prior where they tell nothing. Of `options`
// only the limits of depth count.
Estimator MakeCoarseEstimator(const DirectOptions& options = {});

}  // namespace rgbd_pose
