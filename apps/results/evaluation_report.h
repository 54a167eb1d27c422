#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/evaluation/evaluation.h"

namespace rgbd_pose {

// Formats the report as a table. Each line names the quantity, how it is
// measured and its unit. Errors without any pair of poses are "n/a".
std::string FormatEvaluation(const EvaluationReport& report);

// Formats the report as JSON. Keys end in their unit (_m, _s, _deg). Errors
// without any pair of poses are null, with a count of 0; standard deviations of
// undetermined values are infinite, which becomes null in a file.
nlohmann::json EvaluationToJson(const EvaluationReport& report);

}  // namespace rgbd_pose
