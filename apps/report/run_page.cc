#include "apps/report/run_page.h"

#include <system_error>

#include "apps/report/report_page.h"
#include "core/util/input_error.h"

namespace rgbd_pose {

std::string WriteRunPage(const std::filesystem::path& staging_dir,
                         const std::string& out, std::string* why_not) {
  if (!HasReportLibrary()) {
    return std::string("report in   ") + kNoReportLibrary + "\n";
  }
  try {
    WriteRunReport(staging_dir.string());
    return "report in   " + out + "/report.html\n";
  } catch (const InputError& error) {
    *why_not = error.what();
    std::error_code ignored;
    std::filesystem::remove(staging_dir / "report.html", ignored);
    return "";
  }
}

}  // namespace rgbd_pose
