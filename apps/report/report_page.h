#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rgbd_pose {

// Files that the build put into the program (apps/CMakeLists.txt).
struct ReportAssets {
  std::string_view library;  // plotly.js; empty if the build did not find it
  std::string_view library_license;
  std::string_view page;  // with places for the rest: %STYLE% and so on
  std::string_view style;
  std::string_view script;

  // The live page, its style and script besides those of reports.
  std::string_view view_page;
  std::string_view view_style;
  std::string_view view_script;
};

ReportAssets EmbeddedReportAssets();

// Whether this program was built with the plotting library that pages need.
bool HasReportLibrary();

// What a program says instead of the name of a page it cannot write.
constexpr char kNoReportLibrary[] =
    "no file: built without plotly.js, which scripts/install_dependencies "
    "fetches";

// Data within a page: JSON that ends no element.
std::string InlineData(const nlohmann::json& data);

// A page with each place (%STYLE%, say) replaced by its content, in their
// order.
std::string FillPage(
    std::string_view page,
    const std::vector<std::pair<std::string_view, std::string>>& parts);

// A page in one file that needs nothing else: the data, the plotting library
// and our scripts (apps/report), which draw what `kind` says: "run", "batch",
// "comparison" or "sweep".
std::string ReportPage(std::string_view kind, const nlohmann::json& data);

// Writes report.html of a run from the files in its folder; returns its path.
// Throws InputError for files that are missing or broken.
std::string WriteRunReport(const std::string& run_folder);

// The same for a batch, from its summary.csv.
std::string WriteBatchReport(const std::string& batch_folder);

// The same for a comparison by rgbd_compare, from the files in its folder.
std::string WriteComparisonReport(const std::string& folder);

// Writes report.html into the folder of a run that is not published yet, `out`
// being the one it will have. Returns what a program prints of it: where it is,
// or that this build writes none. A disk that is too full for the page costs no
// other result: the part of it is removed, and `why_not` says so.
std::string WriteRunPage(const std::filesystem::path& staging_dir,
                         const std::string& out, std::string* why_not);

}  // namespace rgbd_pose
