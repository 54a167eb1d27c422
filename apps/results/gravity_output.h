#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/inertial/gravity_estimate.h"

namespace rgbd_pose {

// The object `gravity` of metrics.json.
nlohmann::json GravityToJson(const GravityEstimate& gravity);

// Describes that object in one line, for printing.
std::string FormatGravity(const nlohmann::json& gravity);

}  // namespace rgbd_pose
