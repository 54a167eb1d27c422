#include "frontend/files/yaml_edit.h"

#include <algorithm>
#include <optional>
#include <sstream>

namespace rgbd_pose {
namespace {

// Where a key of the file stands, if that is within the lines.
std::optional<size_t> LineOf(const YAML::Node& file, const std::string& key,
                             const std::vector<std::string>& lines) {
  for (const auto& entry : file) {
    if (entry.first.Scalar() != key) continue;
    const size_t line = entry.first.Mark().line;
    if (line < lines.size()) return line;
  }
  return std::nullopt;
}

}  // namespace

std::string EditLines(const std::string& text, const YAML::Node& file,
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
    const std::optional<size_t> line = LineOf(file, key, lines);
    if (line.has_value()) is_left_out[*line] = true;
  }
  size_t last = 0;  // of those that change
  std::string added;
  for (const auto& [key, value] : values) {
    const std::optional<size_t> line = LineOf(file, key, lines);
    if (!line.has_value()) {
      if (value != "0") added += key + ": " + value + "\n";
      continue;
    }
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
