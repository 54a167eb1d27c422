#include "frontend/files/yaml_edit.h"

#include <algorithm>
#include <sstream>

namespace rgbd_pose {
namespace {

// The line of `key: value` that is one of the file and nothing else; nothing if
// there is none: many keys may share a line, a value may have several, or a
// name by which others refer to it.
std::optional<size_t> OwnLine(const YAML::Node& file,
                              const std::vector<std::string>& lines,
                              const std::string& key) {
  for (const auto& entry : file) {
    if (entry.first.Scalar() != key) continue;
    const YAML::Mark at = entry.first.Mark();
    const size_t line = at.line;
    if (at.column != 0 || line >= lines.size() ||
        lines[line].find(": &") != std::string::npos) {
      return std::nullopt;
    }
    try {
      const YAML::Node alone = YAML::Load(lines[line]);
      const bool is_all =
          alone.IsMap() && alone.size() == 1 &&
          YAML::Dump(alone.begin()->second) == YAML::Dump(entry.second);
      return is_all ? std::optional(line) : std::nullopt;
    } catch (const YAML::Exception&) {
      return std::nullopt;  // begins or ends what goes on elsewhere
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> EditLines(const std::string& text,
                                     const YAML::Node& file,
                                     const YamlLines& values,
                                     const std::vector<std::string>& left_out,
                                     const YamlLines& more) {
  std::stringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line);
  }
  std::vector<bool> is_left_out(lines.size(), false);
  for (const std::string& key : left_out) {
    if (!file[key].IsDefined()) continue;
    const std::optional<size_t> line = OwnLine(file, lines, key);
    if (!line.has_value()) return std::nullopt;
    is_left_out[*line] = true;
  }
  size_t last = 0;  // of those that change
  std::string added;
  for (const auto& [key, value] : values) {
    if (!file[key].IsDefined()) {
      if (value != "0") added += key + ": " + value + "\n";
      continue;
    }
    const std::optional<size_t> line = OwnLine(file, lines, key);
    if (!line.has_value()) return std::nullopt;
    const size_t comment = lines[*line].find(" #");
    lines[*line] =
        key + ": " + value +
        (comment == std::string::npos ? "" : lines[*line].substr(comment));
    last = std::max(last, *line);
  }
  for (const auto& [key, value] : more) added += key + ": " + value + "\n";
  std::string result;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (!is_left_out[i]) result += lines[i] + "\n";
    if (i == last) result += added;
  }
  return result;
}

YAML::Node With(const YAML::Node& map, const std::string& key,
                const YAML::Node& value) {
  YAML::Node result(YAML::NodeType::Map);
  result.SetStyle(map.Style());
  bool is_there = false;
  for (const auto& entry : map) {
    const bool is_it = entry.first.Scalar() == key;
    if (is_it && is_there) continue;  // it counts the first time only
    result.force_insert(entry.first, is_it ? value : entry.second);
    is_there |= is_it;
  }
  if (!is_there) result.force_insert(key, value);
  return result;
}

YAML::Node Without(const YAML::Node& map,
                   const std::vector<std::string>& keys) {
  YAML::Node result(YAML::NodeType::Map);
  result.SetStyle(map.Style());
  for (const auto& entry : map) {
    if (std::count(keys.begin(), keys.end(), entry.first.Scalar()) == 0) {
      result.force_insert(entry.first, entry.second);
    }
  }
  return result;
}

}  // namespace rgbd_pose
