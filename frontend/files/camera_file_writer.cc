#include "frontend/files/camera_file_writer.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <utility>
#include <vector>

#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/yaml_section.h"

namespace rgbd_pose {
namespace {

using Lines = std::vector<std::pair<std::string, std::string>>;  // key, value

// With all digits that make a difference.
std::string Digits(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.10g", value);
  return text;
}

std::string List(const std::vector<double>& values) {
  std::string text = "[";
  for (size_t i = 0; i < values.size(); ++i) {
    text += (i > 0 ? ", " : "") + Digits(values[i]);
  }
  return text + "]";
}

std::vector<double> ToList(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// The keys that all layouts share.
Lines DepthLines(const RgbdCamera& camera) {
  Lines lines;
  if (camera.depth_errors.inverse_depth_offset != 0.0) {
    lines.emplace_back("inverse_depth_offset",
                       Digits(camera.depth_errors.inverse_depth_offset));
  }
  if (camera.depth_errors.depth_time_offset != 0.0) {
    lines.emplace_back("depth_time_offset",
                       Digits(camera.depth_errors.depth_time_offset));
  }
  const Rigid3d& moved = camera.depth_errors.depth_from_color;
  if (moved.Angle() > 0.0 || !moved.translation.isZero(0.0)) {
    const Eigen::AngleAxisd turn(moved.rotation);
    lines.emplace_back("depth_rotation",
                       List(ToList(turn.angle() * turn.axis())));
    lines.emplace_back("depth_translation", List(ToList(moved.translation)));
  }
  return lines;
}

Lines OrbSlamLines(const RgbdCamera& rgbd, const std::string& prefix) {
  const Camera& camera = rgbd.camera;
  Lines lines;
  for (const CameraParameter& parameter : kCameraParameters) {
    lines.emplace_back(prefix + parameter.name,
                       Digits(camera.*parameter.value));
  }
  lines.emplace_back("Camera.width", std::to_string(camera.width));
  lines.emplace_back("Camera.height", std::to_string(camera.height));
  return lines;
}

// The keys of what is wrong with depth.
constexpr const char* kDepthKeys[] = {"inverse_depth_offset",
                                      "depth_time_offset", "depth_rotation",
                                      "depth_translation"};

bool IsOfKey(const std::string& line, const std::string& key) {
  if (line.compare(0, key.size(), key) != 0) return false;
  const size_t next = line.find_first_not_of(' ', key.size());
  return next != std::string::npos && line[next] == ':';
}

// A file of one `key: value` a line with other values; keys that it lacks are
// added where they are not 0.
std::string EditLines(const std::string& text, const Lines& values,
                      const Lines& depth) {
  std::stringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (std::none_of(std::begin(kDepthKeys), std::end(kDepthKeys),
                     [&](const char* key) { return IsOfKey(line, key); })) {
      lines.push_back(line);
    }
  }
  for (const auto& [key, value] : values) {
    const auto line = std::find_if(
        lines.begin(), lines.end(),
        [&key = key](const std::string& l) { return IsOfKey(l, key); });
    if (line != lines.end()) {
      const size_t comment = line->find(" #");
      *line = key + ": " + value +
              (comment == std::string::npos ? "" : line->substr(comment));
    } else if (value != "0") {
      lines.push_back(key + ": " + value);
    }
  }
  for (const auto& [key, value] : depth) lines.push_back(key + ": " + value);
  std::string result;
  for (const std::string& line : lines) result += line + "\n";
  return result;
}

YAML::Node ToNode(const std::vector<double>& values) {
  YAML::Node node;
  for (const double value : values) node.push_back(Digits(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

// A YAML file in ROS' or Kalibr's layout with other values.
std::string EditNodes(const RgbdCamera& rgbd, YAML::Node file) {
  const Camera& c = rgbd.camera;
  if (file["camera_matrix"].IsDefined()) {
    file["camera_matrix"]["data"] =
        ToNode({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0});
    file["distortion_coefficients"]["data"] =
        ToNode({c.k1, c.k2, c.p1, c.p2, c.k3});
    YAML::Node size = file["distortion_coefficients"]["cols"];
    if (size.IsDefined()) size = 5;
    // What a rectified image would be seen with is of the old camera.
    file.remove("projection_matrix");
  } else {
    file["cam0"]["intrinsics"] = ToNode({c.fx, c.fy, c.cx, c.cy});
    file["cam0"]["distortion_coeffs"] = ToNode({c.k1, c.k2, c.p1, c.p2});
  }
  const char* const scale = file["RGBD.DepthMapFactor"].IsDefined()
                                ? "RGBD.DepthMapFactor"
                                : "DepthMapFactor";
  file[scale] = Digits(rgbd.depth_scale);
  for (const char* key : kDepthKeys) file.remove(key);
  std::string text = YAML::Dump(file) + "\n";
  for (const auto& [key, value] : DepthLines(rgbd)) {
    text += key + ": " + value + "\n";
  }
  return text;
}

}  // namespace

std::string FormatCameraFile(const RgbdCamera& camera,
                             const std::string& like) {
  const bool is_preset = like.empty() || CameraPreset(like).has_value();
  std::string text = "%YAML:1.0\n";
  std::string prefix = "Camera.";
  std::string scale = "DepthMapFactor";
  if (!is_preset) {
    ResolveCamera(like);  // complains of what is wrong with it
    text = ReadTextFile(like);
    const YamlSection file = YamlSection::FromFile(like);
    if (file.HasKeyStartingWith("Camera1.")) prefix = "Camera1.";
    if (file.Has("RGBD.DepthMapFactor")) scale = "RGBD.DepthMapFactor";
    if (!file.Has(prefix + "fx")) {
      return EditNodes(camera, YAML::Load(text));
    }
  }
  Lines lines = OrbSlamLines(camera, prefix);
  lines.emplace_back(scale, Digits(camera.depth_scale));
  return EditLines(text, lines, DepthLines(camera));
}

}  // namespace rgbd_pose
