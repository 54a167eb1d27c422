#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Whether this program was built with the plotting library that pages need.
bool HasReportLibrary();

// A page in one file that needs nothing else: the data, the plotting library
// and our scripts (apps/report), which draw what `kind` says: "run" or "batch".
std::string ReportPage(std::string_view kind, const nlohmann::json& data);

// Writes report.html of a run from the files in its folder; returns its path.
// Throws InputError for files that are missing or broken.
std::string WriteRunReport(const std::string& run_folder);

// The same for a batch, from its summary.csv.
std::string WriteBatchReport(const std::string& batch_folder);

}  // namespace rgbd_pose
