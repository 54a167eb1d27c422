#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rgbd_pose {

// The flags of a config.flags in groups: [title, [[name, value], ...]]. Throws
// InputError if the file cannot be read.
nlohmann::json ReadReportSettings(const std::string& flag_file);

// The value of a flag in such groups; empty if it is not there.
std::string SettingOf(const nlohmann::json& groups, const std::string& name);

}  // namespace rgbd_pose
