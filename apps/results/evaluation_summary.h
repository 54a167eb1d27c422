#pragma once

#include <string>

#include "core/evaluation/evaluation.h"

namespace rgbd_pose {

// The errors of a run that people ask for first, in at most nine lines:
// FormatEvaluation has all. Errors without any pair of poses are "n/a".
std::string FormatEvaluationSummary(const EvaluationReport& report);

}  // namespace rgbd_pose
