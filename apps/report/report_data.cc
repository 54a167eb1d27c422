#include "apps/report/report_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/shell/csv_table.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

using nlohmann::json;

namespace {

// Division by a power of ten gives the double nearest to the short decimal,
// which is then written with few digits; NaN is written as null.
double Rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

}  // namespace

std::vector<double> Elapsed(std::vector<double> times) {
  for (size_t i = times.size(); i-- > 0;) times[i] -= times[0];
  return times;
}

ReportThinning::ReportThinning(size_t frames, size_t max_points)
    : every(std::max<size_t>((frames + max_points - 1) / max_points, 1)) {}

json ReportThinning::First(const std::vector<double>& values,
                           int decimals) const {
  json result = json::array();
  for (size_t i = 0; i < values.size(); i += every) {
    result.push_back(Rounded(values[i], decimals));
  }
  return result;
}

json ReportThinning::Largest(const std::vector<double>& values,
                             int decimals) const {
  json result = json::array();
  for (size_t i = 0; i < values.size(); i += every) {
    double largest = NAN;
    const size_t end = std::min(i + every, values.size());
    // fmax skips NaN.
    for (size_t k = i; k < end; ++k) largest = std::fmax(largest, values[k]);
    result.push_back(Rounded(largest, decimals));
  }
  return result;
}

json ReadReportSettings(const std::string& flag_file) {
  json groups = json::array();
  std::istringstream text(ReadTextFile(flag_file));
  std::string line;
  while (std::getline(text, line)) {
    const size_t equals = line.find('=');
    if (line.rfind("# ", 0) == 0) {
      groups.push_back({line.substr(2), json::array()});
    } else if (line.rfind("--", 0) == 0 && equals != std::string::npos &&
               !groups.empty()) {
      groups.back()[1].push_back(
          {line.substr(2, equals - 2), line.substr(equals + 1)});
    }
  }
  return groups;
}

std::string SettingOf(const json& groups, const std::string& name) {
  for (const json& group : groups) {
    for (const json& flag : group[1]) {
      if (flag[0] == name) return flag[1];
    }
  }
  return "";
}

json BatchReportData(const std::string& batch_folder) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::absolute(batch_folder).lexically_normal() / "";
  const CsvTable table = CsvTable::Read(folder / "summary.csv");
  json rows(std::vector<json>(table.size(), json::object()));
  for (const char* name :
       {"sequence", "cost", "loss", "frontend", "tracker", "part", "status"}) {
    const std::vector<std::string> words = table.Words(name);
    for (size_t i = 0; i < words.size(); ++i) rows[i][name] = words[i];
  }
  for (const char* name : {"repeat", "frames", "tracked_share", "ate_rmse_m",
                           "rpe_seconds_translation_m",
                           "rpe_seconds_rotation_deg", "track_ms_median"}) {
    const std::vector<double> numbers = table.Numbers(name);
    for (size_t i = 0; i < numbers.size(); ++i) rows[i][name] = numbers[i];
  }
  const std::vector<std::string> runs = table.Words("folder");
  for (size_t i = 0; i < runs.size(); ++i) {
    const fs::path report = fs::path(runs[i]) / "report.html";
    if (PathExists(folder / report)) rows[i]["report"] = report.string();
  }
  return {{"name", folder.parent_path().filename().string()}, {"rows", rows}};
}

}  // namespace rgbd_pose
