#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "apps/pipeline/settings.h"

namespace rgbd_pose {

// A value that is set by its name in some table.
struct NamedSetting {
  std::function<std::string()> get;
  std::function<void(const std::string&)> set;  // InputError if unknown
};

// A value of the settings, for flags, keyword arguments and whatever else sets
// them: one row here is all that it takes.
struct Setting {
  const char* name;        // as users write it
  std::string_view group;  // of those that belong together
  const char* help;        // what it means, with its unit
  std::variant<int*, double*, bool*, NamedSetting> value;
  std::vector<std::string> choices = {};  // the names there are, if by name
};

// Any text: whether it makes sense is found out where it is used.
NamedSetting Text(std::string* text);

// Rows that are about matches alone.
inline constexpr char kEstimationGroup[] = "Estimation";

// All rows, in the order of --help. They write to the settings, which must
// outlive them.
std::vector<Setting> SettingTable(OdometrySettings* settings);

// A table without the row of that name.
std::vector<Setting> WithoutRow(std::string_view name,
                                std::vector<Setting> table);

}  // namespace rgbd_pose
