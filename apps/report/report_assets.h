#pragma once

#include <string_view>

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

}  // namespace rgbd_pose
