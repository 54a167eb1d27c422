#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rgbd_pose {

// A value that is set by name.
struct NamedSetting {
  std::function<std::string()> get;             // current name
  std::function<void(const std::string&)> set;  // InputError if unknown
};

// A user setting. One row makes it available to flags and keyword arguments.
struct Setting {
  const char* name;        // as users write it
  std::string_view group;  // title of the group of settings
  const char* help;        // meaning and unit
  // The value that is set. Texts are checked where they are used.
  std::variant<int*, uint32_t*, double*, bool*, std::string*, NamedSetting>
      value;
  std::vector<std::string> choices = {};  // valid names, if it takes names
};

// Returns the table without the row of this name.
inline std::vector<Setting> WithoutRow(std::string_view name,
                                       std::vector<Setting> table) {
  table.erase(
      std::remove_if(table.begin(), table.end(),
                     [name](const Setting& row) { return row.name == name; }),
      table.end());
  return table;
}

}  // namespace rgbd_pose
