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

// The cost of that name, or null.
std::unique_ptr<MotionCost> MakeCost(std::string_view name);

// What is taken where nobody says otherwise.
inline constexpr char kDefaultCost[] = "bidirectional_point";
inline constexpr char kDefaultLoss[] = "tukey";

// Costs by name ("bidirectional_point+motion_prior"), each with its loss: one
// for all or one each ("tukey", "tukey,none"), see ParseLoss. Throws InputError
// listing the names there are.
std::vector<RobustCost> MakeRobustCosts(
    const std::string& cost_names = kDefaultCost,
    const std::string& loss_names = kDefaultLoss);

// The same of costs made otherwise: `make` gives the cost of a name, null if it
// is none of `names`.
std::vector<RobustCost> MakeRobustCosts(
    const std::string& cost_names, const std::string& loss_names,
    const std::vector<std::string>& names,
    const std::function<std::unique_ptr<MotionCost>(const std::string& name)>&
        make);

}  // namespace rgbd_pose
