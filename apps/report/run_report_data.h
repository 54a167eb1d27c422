#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rgbd_pose {

// More frames than this are drawn in groups, so that a page stays small.
constexpr int kMaxReportPoints = 4000;

// All that the page of a run shows, from the files in its folder: frames.csv,
// trajectory.txt, metrics.json, config.flags and, where there was a ground
// truth, errors.csv. Frames are in columns; numbers that are not known are
// null. Throws InputError for files that are missing or broken.
nlohmann::json RunReportData(const std::string& run_folder);

}  // namespace rgbd_pose
