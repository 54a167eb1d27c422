#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rgbd_pose {

// YAML files with other values.

using YamlLines =
    std::vector<std::pair<std::string, std::string>>;  // key, value

// The text of a file with other values, its other lines as they are. `file` is
// what it was parsed to. Keys of `values` that it lacks are added where they
// are not 0; keys of `left_out` go, but for those of `more`, which are as said
// there. Nothing if that cannot be done line by line: many keys may share a
// line, a value may have several.
std::optional<std::string> EditLines(const std::string& text,
                                     const YAML::Node& file,
                                     const YamlLines& values,
                                     const std::vector<std::string>& left_out,
                                     const YamlLines& more);

// A map with another value of one key, or without some. What it had is left as
// it is, as other keys may refer to it.
YAML::Node With(const YAML::Node& map, const std::string& key,
                const YAML::Node& value);
YAML::Node Without(const YAML::Node& map, const std::vector<std::string>& keys);

}  // namespace rgbd_pose
