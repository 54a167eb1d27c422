#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/evaluation/error_statistics.h"
#include "core/evaluation/relative_errors.h"

// Parts of the evaluation's table and of its JSON. Errors without a single
// pair of poses are "n/a" in the one and null in the other.

namespace rgbd_pose {

// Angles in radians as degrees.
ErrorStatistics InDegrees(const ErrorStatistics& radians);

// One line: RMSE, median, mean and maximum of a quantity, in its unit.
std::string FormatStatistics(const char* quantity, const ErrorStatistics& e);
nlohmann::json StatisticsToJson(const ErrorStatistics& e);

// Median, 90 % and 99 % of errors over numbers of frames, in mm and degrees:
// lines with a head of their own, none for none.
std::string FormatFrameErrors(const std::vector<FramePoseError>& errors);
nlohmann::json FrameErrorsToJson(const std::vector<FramePoseError>& errors);

}  // namespace rgbd_pose
