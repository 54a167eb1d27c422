#include "apps/report/report_settings.h"

#include <sstream>

#include "core/util/text_file.h"

namespace rgbd_pose {

using nlohmann::json;

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

}  // namespace rgbd_pose
