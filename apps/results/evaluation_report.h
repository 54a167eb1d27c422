#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/evaluation.h"
#include "core/evaluation/truth_alignment.h"

namespace rgbd_pose {

// Formats the report as a table. Each line names the quantity, how it is
// measured and its unit. Errors without any pair of poses are "n/a".
std::string FormatEvaluation(const EvaluationReport& report);

// Formats the report as JSON. Keys end in their unit (_m, _s, _deg). Errors
// without any pair of poses are null, with a count of 0.
nlohmann::json EvaluationToJson(const EvaluationReport& report);

// Formats the best-fitting clock offset and TruthFixing (ms, degrees, mm, each
// with its standard deviation), and the errors with these corrections over
// motions of `rpe_delta_seconds`. One line if there is no alignment.
std::string FormatTruthAlignment(const TruthAlignment& alignment,
                                 double rpe_delta_seconds);

// The same as JSON. The standard deviation of an undetermined value is null;
// all values are null if there is no alignment.
nlohmann::json TruthAlignmentToJson(const TruthAlignment& alignment,
                                    double rpe_delta_seconds);

}  // namespace rgbd_pose
