#include "costs/cost_factory.h"

#include <utility>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "costs/assembly/cost_of.h"
#include "costs/cost_list.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {

std::vector<std::string> CostNames() { return NamesOfTypes(ResidualTypes()); }

std::unique_ptr<MotionCost> MakeCost(std::string_view name) {
  return MakeNamed<CostOf>(ResidualTypes(), name);
}

std::vector<RobustCost> MakeRobustCosts(
    const std::string& cost_names, const std::string& loss_names,
    const std::vector<std::string>& names,
    const std::function<std::unique_ptr<MotionCost>(const std::string& name)>&
        make) {
  const std::vector<std::string> costs = SplitText(cost_names, '+');
  const std::vector<std::string> losses = SplitText(loss_names, ',');
  if (losses.size() != 1 && losses.size() != costs.size()) {
    throw InputError("'" + loss_names + "' names " +
                     std::to_string(losses.size()) + " losses for " +
                     std::to_string(costs.size()) +
                     " costs; give one for all or one for each");
  }
  std::vector<RobustCost> terms;
  for (size_t i = 0; i < costs.size(); ++i) {
    std::unique_ptr<MotionCost> cost = make(costs[i]);
    if (cost == nullptr) throw UnknownName("cost", costs[i], names);
    const std::string& loss_name = losses[losses.size() == 1 ? 0 : i];
    std::unique_ptr<ceres::LossFunction> loss =
        ParseLoss(loss_name).Make(cost->degrees_of_freedom());
    terms.push_back({std::move(cost), std::move(loss)});
  }
  return terms;
}

}  // namespace rgbd_pose
