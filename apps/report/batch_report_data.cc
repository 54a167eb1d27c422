#include <cmath>
#include <filesystem>
#include <vector>

#include "apps/report/run_report_data.h"
#include "apps/shell/csv_table.h"

namespace rgbd_pose {

using nlohmann::json;

json BatchReportData(const std::string& batch_folder) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::absolute(batch_folder).lexically_normal();
  const CsvTable table = CsvTable::Read((folder / "summary.csv").string());
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
    for (size_t i = 0; i < numbers.size(); ++i) {
      rows[i][name] = std::isnan(numbers[i]) ? json() : json(numbers[i]);
    }
  }
  // A path with a slash at its end has no file name.
  const fs::path named = folder.has_filename() ? folder : folder.parent_path();
  return {{"name", named.filename().string()}, {"rows", rows}};
}

}  // namespace rgbd_pose
