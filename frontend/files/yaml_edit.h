#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <utility>
#include <vector>

namespace rgbd_pose {

// YAML files with other values.

using YamlLines =
    std::vector<std::pair<std::string, std::string>>;  // key, value

// The text of a file with other values, its other lines as they are. `file` is
// what it was parsed to. Keys of `values` that it lacks are added where they
// are not 0, lines of `left_out` go, those of `more` come. Right only where
// each of these keys has a line of its own: many may share one, a value may
// have several, or a name by which others refer to it.
std::string EditLines(const std::string& text, const YAML::Node& file,
                      const YamlLines& values,
                      const std::vector<std::string>& left_out,
                      const YamlLines& more);

// A map with another value of one key, or without some. What it had is left as
// it is, as other keys may refer to it.
YAML::Node With(const YAML::Node& map, const std::string& key,
                const YAML::Node& value);
YAML::Node Without(const YAML::Node& map, const std::vector<std::string>& keys);

}  // namespace rgbd_pose
