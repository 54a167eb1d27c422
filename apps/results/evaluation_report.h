#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/evaluation.h"
#include "core/evaluation/truth_alignment.h"

namespace rgbd_pose {

// The report as a table for people: each line says what is measured, how and
// in which unit. Errors without a single pair of poses are "n/a".
std::string FormatEvaluation(const EvaluationReport& report);

// The report for programs. Keys end in their unit (_m, _s, _deg); errors
// without a single pair of poses are null, with a count of 0.
nlohmann::json EvaluationToJson(const EvaluationReport& report);

// Lines of the table: the clock and the fixing of the truth that fit best (ms,
// degrees, mm, each with its standard deviation), and the errors there over
// motions of `rpe_delta_seconds`. One line where there is none.
std::string FormatTruthAlignment(const TruthAlignment& alignment,
                                 double rpe_delta_seconds);

// The same for programs; a standard deviation of what is not determined is
// null, as are figures where there is no alignment.
nlohmann::json TruthAlignmentToJson(const TruthAlignment& alignment,
                                    double rpe_delta_seconds);

}  // namespace rgbd_pose
