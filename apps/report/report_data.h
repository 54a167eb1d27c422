#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

// Times since the first frame, s.
std::vector<double> Elapsed(std::vector<double> times);

// Puts frames in groups of `every`, each drawn as one point, so that a page
// stays small.
class ReportThinning {
 public:
  ReportThinning(size_t frames, size_t max_points);

  size_t every() const { return every_; }

  // The first of each group; null where a value is not finite.
  nlohmann::json First(const std::vector<double>& values, int decimals) const;

  // The largest of each group, so that no peak is lost; null where there is
  // none.
  nlohmann::json Largest(const std::vector<double>& values, int decimals) const;

 private:
  size_t every_;
};

// The flags of a config.flags in groups: [title, [[name, value], ...]]. Throws
// InputError if the file cannot be read.
nlohmann::json ReadReportSettings(const std::string& flag_file);

// The value of a flag in such groups; empty if it is not there.
std::string SettingOf(const nlohmann::json& groups, const std::string& name);

}  // namespace rgbd_pose
