#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rgbd_pose {

// More poses than this, of all paths of a comparison together, are drawn in
// groups, so that a page stays small.
constexpr int kMaxComparedPoints = 15000;

// All that the page of a comparison shows, from the files in its folder:
// config.flags and, of a sweep, sweep.csv, else tables.csv and paths.csv.
// `sequences` or `methods` (of a sweep) say which it is. Numbers that are not
// known are null. Throws InputError for files that are missing or broken.
nlohmann::json CompareReportData(const std::string& folder);

}  // namespace rgbd_pose
