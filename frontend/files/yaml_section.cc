#include "frontend/files/yaml_section.h"

#include <algorithm>
#include <cmath>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

YamlSection YamlSection::FromFile(const std::string& path) {
  return FromText(ReadTextFile(path), path);
}

YamlSection YamlSection::FromText(const std::string& text,
                                  const std::string& path) {
  std::string yaml(WithoutByteOrderMark(text));
  // The first line of OpenCV's files, %YAML:1.0, is not valid YAML. Its line
  // end is kept, which leaves the line numbers unchanged.
  if (yaml.rfind("%YAML", 0) == 0) yaml.erase(0, yaml.find_first_of("\r\n"));
  try {
    const YAML::Node node = YAML::Load(yaml);
    return {path, "", node.IsMap() ? node : YAML::Node(YAML::NodeType::Map)};
  } catch (const YAML::Exception& error) {
    throw InputError(path, error.mark.line + 1, "not valid YAML: " + error.msg);
  }
}

bool YamlSection::Has(const std::string& key) const {
  return node_[key].IsDefined();
}

std::vector<std::string> YamlSection::Keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) keys.push_back(entry.first.Scalar());
  return keys;
}

bool YamlSection::HasKeyStartingWith(const std::string& start) const {
  const std::vector<std::string> keys = Keys();
  return std::any_of(keys.begin(), keys.end(), [&start](const auto& key) {
    return key.rfind(start, 0) == 0;
  });
}

YamlSection YamlSection::Child(const std::string& key) const {
  const YAML::Node child = Find(key);
  if (!child.IsMap()) Fail(key, "must be a section with keys");
  return {path_, prefix_ + key + ".", child};
}

double YamlSection::Number(const std::string& key) const {
  return ToNumber(key, Find(key));
}

double YamlSection::NumberOr(const std::string& key, double fallback) const {
  return Has(key) ? Number(key) : fallback;
}

std::vector<double> YamlSection::Numbers(
    const std::string& key, const std::vector<size_t>& lengths) const {
  const YAML::Node list = Find(key);
  if (!list.IsSequence() ||
      std::count(lengths.begin(), lengths.end(), list.size()) == 0) {
    std::vector<std::string> wanted;
    for (const size_t length : lengths) {
      wanted.push_back(std::to_string(length));
    }
    Fail(key, "needs a list of " + Join(wanted, " or ") + " numbers");
  }
  std::vector<double> numbers;
  for (const auto& item : list) numbers.push_back(ToNumber(key, item));
  return numbers;
}

std::vector<double> YamlSection::Matrix(const std::string& key) const {
  const YAML::Node list = Find(key);
  if (list.IsMap()) return Child(key).Numbers("data", {16});
  if (list.IsSequence() && list.size() == 16) return Numbers(key, {16});
  std::vector<double> numbers;
  for (size_t i = 0; list.IsSequence() && i < list.size(); ++i) {
    const YAML::Node row = list[i];
    if (!row.IsSequence() || row.size() != 4) break;
    for (const auto& item : row) numbers.push_back(ToNumber(key, item));
  }
  if (numbers.size() == 16 && list.size() == 4) return numbers;
  Fail(key, "needs a list of 4 lists of 4 numbers");
}

Rigid3d YamlSection::RigidMotion(const std::string& key) const {
  const std::vector<double> m = Matrix(key);
  Eigen::Matrix3d rotation;
  rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  const bool is_rigid =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() <
          1e-3 &&
      rotation.determinant() > 0.0;
  if (!is_rigid) Fail(key, "contains no valid rotation");
  return Rigid3d(Eigen::Quaterniond(rotation), {m[3], m[7], m[11]});
}

int YamlSection::Pixels(const std::string& key) const {
  return Pixels(key, Number(key));
}

int YamlSection::Pixels(const std::string& key, double number) const {
  constexpr double kMaxPixels = 65536.0;
  if (number < 1.0 || number > kMaxPixels || number != std::floor(number)) {
    Fail(key, "must be a positive whole number of pixels");
  }
  return static_cast<int>(number);
}

std::string YamlSection::Word(const std::string& key,
                              const std::vector<std::string>& known) const {
  if (!Has(key)) return known.front();
  std::string value = node_[key].Scalar();
  if (std::count(known.begin(), known.end(), value) > 0) return value;
  Fail(key, "'" + value + "' is not supported, only: " + Join(known));
}

void YamlSection::Fail(const std::string& key,
                       const std::string& message) const {
  throw InputError(path_, node_[key].Mark().line + 1,
                   prefix_ + key + " " + message);
}

YAML::Node YamlSection::Find(const std::string& key) const {
  if (!Has(key)) {
    throw InputError(path_, node_.Mark().line + 1,
                     prefix_ + key + " is missing below this line");
  }
  return node_[key];
}

double YamlSection::ToNumber(const std::string& key,
                             const YAML::Node& node) const {
  return ParseNumber(node.Scalar(), path_, node.Mark().line + 1, prefix_ + key);
}

}  // namespace rgbd_pose
