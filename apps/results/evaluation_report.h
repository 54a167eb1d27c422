#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/evaluation.h"

namespace rgbd_pose {

// The report as a table for people: each line says what is measured, how and
// in which unit. Errors without a single pair of poses are "n/a".
std::string FormatEvaluation(const EvaluationReport& report);

// The report for programs. Keys end in their unit (_m, _s, _deg); errors
// without a single pair of poses are null, with a count of 0.
nlohmann::json EvaluationToJson(const EvaluationReport& report);

}  // namespace rgbd_pose
