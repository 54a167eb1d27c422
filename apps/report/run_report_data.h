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

// All that the page of a batch shows: the name of its folder and a row for
// every run, from summary.csv of rgbd_batch; figures that a run lacks are null.
// Throws InputError if the file is missing or broken.
nlohmann::json BatchReportData(const std::string& batch_folder);

// More poses than this, of all paths of a comparison together, are drawn in
// groups, so that a page stays small.
constexpr int kMaxComparedPoints = 15000;

// All that the page of a comparison shows, from the files in its folder:
// config.flags and, of a sweep, sweep.csv, else tables.csv and paths.csv.
// `sequences` or `methods` (of a sweep) say which it is. Numbers that are not
// known are null. Throws InputError for files that are missing or broken.
nlohmann::json CompareReportData(const std::string& folder);

}  // namespace rgbd_pose
