#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/consistency.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/relative_errors.h"
#include "core/evaluation/truth_alignment.h"
#include "core/util/units.h"

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

// Parts of the table and of its JSON.

// In another unit.
ErrorStatistics Scaled(ErrorStatistics errors, double factor);

// Angles in radians as degrees.
inline ErrorStatistics InDegrees(const ErrorStatistics& radians) {
  return Scaled(radians, kDegreesPerRadian);
}

// One line: RMSE, median, mean and maximum of a quantity, in its unit.
std::string FormatStatistics(const char* quantity, const ErrorStatistics& e);
nlohmann::json StatisticsToJson(const ErrorStatistics& e);

// Median, 90 % and 99 % of relative errors, in mm and degrees.
std::string FormatQuantiles(const RelativePoseError& error);

// Of the motions of a run: those that are wrong, and NEES.
std::string FormatConsistency(const RunConsistency& consistency);
nlohmann::json ConsistencyToJson(const RunConsistency& consistency);

}  // namespace rgbd_pose
