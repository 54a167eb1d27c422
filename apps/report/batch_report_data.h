#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rgbd_pose {

// All that the page of a batch shows: the name of its folder and a row for
// every run, from summary.csv of rgbd_batch; figures that a run lacks are null.
// Throws InputError if the file is missing or broken.
nlohmann::json BatchReportData(const std::string& batch_folder);

}  // namespace rgbd_pose
