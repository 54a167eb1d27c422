#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/estimation/motion_cost.h"

namespace rgbd_pose {

// The names of all costs, in the order of the type list.
std::vector<std::string> CostNames();

// The cost with that name, or null.
std::unique_ptr<MotionCost> MakeCost(std::string_view name);

// The defaults.
inline constexpr char kDefaultCost[] = "bidirectional_point";
inline constexpr char kDefaultLoss[] = "tukey";

// Costs by name ("bidirectional_point+motion_prior"), with one loss for all of
// them or one loss each ("tukey", "tukey,none"), see ParseLoss. `make` returns
// the cost with one of `names`, or null. Throws InputError with the list of
// known names.
std::vector<RobustCost> MakeRobustCosts(
    const std::string& cost_names = kDefaultCost,
    const std::string& loss_names = kDefaultLoss,
    const std::vector<std::string>& names = CostNames(),
    const std::function<std::unique_ptr<MotionCost>(const std::string& name)>&
        make = [](const std::string& name) { return MakeCost(name); });

}  // namespace rgbd_pose
