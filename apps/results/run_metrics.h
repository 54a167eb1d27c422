#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/pipeline/run_summary.h"

namespace rgbd_pose {

// As the program prints it: lines of a title and figures.
std::string FormatSummary(const RunSummary& summary);

// For metrics.json.
nlohmann::json SummaryToJson(const RunSummary& summary);
nlohmann::json ResidualsToJson(const ResidualHistogram& residuals);

// The most memory (MB) that this process has had so far.
double PeakMemoryMb();

}  // namespace rgbd_pose
