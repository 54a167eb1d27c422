#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rgbd_pose {

// More frames are drawn in groups, to keep the page small.
constexpr int kMaxReportPoints = 4000;

// All data for the page of a run, from the files in its folder: frames as
// columns, unknown numbers null. Throws InputError for missing or broken files.
nlohmann::json RunReportData(const std::string& run_folder);

// The same for a batch: the name of its folder and the rows of summary.csv.
nlohmann::json BatchReportData(const std::string& batch_folder);

// The same for the poses of all paths of a comparison together.
constexpr int kMaxComparedPoints = 15000;

// The same for a comparison: a sweep has `methods`, the other kind `sequences`.
nlohmann::json CompareReportData(const std::string& folder);

// Times since the first frame, s.
std::vector<double> Elapsed(std::vector<double> times);

// Groups `every` frames into one drawn point, to keep the page small.
struct ReportThinning {
  ReportThinning(size_t frames, size_t max_points);

  // The first value of each group, rounded; NaN, too, which is written as null.
  nlohmann::json First(const std::vector<double>& values, int decimals) const;

  // The largest value of each group, which keeps peaks; NaN if there is none.
  nlohmann::json Largest(const std::vector<double>& values, int decimals) const;

  const size_t every;
};

// The flags of a config.flags in groups: [title, [[name, value], ...]]. Throws
// InputError if the file cannot be read.
nlohmann::json ReadReportSettings(const std::string& flag_file);

// The value of a flag in such groups, or an empty string.
std::string SettingOf(const nlohmann::json& groups, const std::string& name);

}  // namespace rgbd_pose
