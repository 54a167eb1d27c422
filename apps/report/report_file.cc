#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "apps/report/report_data.h"
#include "apps/report/report_page.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

std::string WriteReport(std::string_view kind, const std::string& folder) {
  const nlohmann::json data = kind == "run"     ? RunReportData(folder)
                              : kind == "batch" ? BatchReportData(folder)
                                                : CompareReportData(folder);
  if (data.contains("methods")) kind = "sweep";
  std::string path = (std::filesystem::path(folder) / "report.html").string();
  WriteFileAtomically(path, ReportPage(kind, data));
  return path;
}

}  // namespace rgbd_pose
