#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/consistency.h"
#include "core/evaluation/relative_errors.h"
#include "core/util/units.h"

// Parts of the evaluation's table and of its JSON. Errors without a single
// pair of poses are "n/a" in the one and null in the other.

namespace rgbd_pose {

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
