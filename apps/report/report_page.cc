#include "apps/report/report_page.h"

#include <nlohmann/json.hpp>

namespace rgbd_pose {
namespace {

void ReplaceAll(std::string_view from, std::string_view to, std::string* text) {
  for (size_t at = 0; (at = text->find(from, at)) != std::string::npos;) {
    text->replace(at, from.size(), to);
    at += to.size();
  }
}

// Escapes a script for HTML. Both patterns occur only in strings of the
// scripts. There the escaped form means the same but does not end the element.
std::string InlineScript(std::string_view script) {
  std::string text(script);
  ReplaceAll("</script", "<\\/script", &text);
  ReplaceAll("<!--", "<\\!--", &text);
  return text;
}

}  // namespace

std::string InlineData(const nlohmann::json& data) {
  // Invalid UTF-8 (in folder names) must not make a report fail.
  std::string text = data.dump(-1, ' ', /*ensure_ascii=*/false,
                               nlohmann::json::error_handler_t::replace);
  ReplaceAll("<", "\\u003c", &text);
  return text;
}

std::string FillPage(
    std::string_view page,
    const std::vector<std::pair<std::string_view, std::string>>& parts) {
  // Placeholders are replaced in the order of the page, so that contents are
  // not searched for placeholders.
  std::string filled;
  size_t done = 0;
  for (const auto& [place, content] : parts) {
    const size_t at = page.find(place, done);
    filled += page.substr(done, at - done);
    filled += content;
    done = at + place.size();
  }
  filled += page.substr(done);
  return filled;
}

bool HasReportLibrary() { return !EmbeddedReportAssets().library.empty(); }

std::string ReportPage(std::string_view kind, const nlohmann::json& data) {
  const ReportAssets assets = EmbeddedReportAssets();
  return FillPage(assets.page,
                  {{"%STYLE%", std::string(assets.style)},
                   {"%KIND%", std::string(kind)},
                   {"%DATA%", InlineData(data)},
                   {"%LICENSE%", std::string(assets.library_license)},
                   {"%LIBRARY%", InlineScript(assets.library)},
                   {"%SCRIPT%", InlineScript(assets.script)}});
}

}  // namespace rgbd_pose
