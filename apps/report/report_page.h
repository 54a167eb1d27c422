#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

struct CalibrationResult;

// Files that the build embeds in the program (apps/CMakeLists.txt).
struct ReportAssets {
  std::string_view library;  // plotly.js; empty if not found by the build
  std::string_view library_license;
  std::string_view page;  // with placeholders %STYLE% etc.
  std::string_view style;
  std::string_view script;

  // The live page with its additional style and script.
  std::string_view view_page;
  std::string_view view_style;
  std::string_view view_script;
};

ReportAssets EmbeddedReportAssets();

// Whether the program was built with the plotting library that pages need.
bool HasReportLibrary();

// Printed instead of the file name if a page cannot be written.
constexpr char kNoReportLibrary[] =
    "no file: built without plotly.js; run scripts/install_dependencies and "
    "build again";

// Data as JSON for embedding in a page; it cannot end an HTML element.
std::string InlineData(const nlohmann::json& data);

// Replaces each placeholder of a page (for example %STYLE%) by its content. The
// placeholders must be given in the order of the page.
std::string FillPage(
    std::string_view page,
    const std::vector<std::pair<std::string_view, std::string>>& parts);

// A self-contained page with the data and the scripts that draw its `kind`:
// "run", "batch", "comparison", "sweep" or "calibration".
std::string ReportPage(std::string_view kind, const nlohmann::json& data);

// A self-contained page about a calibration: verdict, parameters, residuals of
// held-out views with both cameras (means over the image show errors of a lens;
// how late a row seems to be, and their spread over the speed in the image,
// those of clocks and shutters), path seen from above.
std::string CalibrationPage(const CalibrationResult& result,
                            const Trajectory& path);

// Writes report.html for a "run", "batch" or "comparison" from the files in its
// folder; returns its path. Throws InputError for missing or broken files.
std::string WriteReport(std::string_view kind, const std::string& folder);

}  // namespace rgbd_pose
