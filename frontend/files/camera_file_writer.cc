#include "frontend/files/camera_file_writer.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/yaml_edit.h"
#include "frontend/files/yaml_section.h"

namespace rgbd_pose {
namespace {

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
YamlLines DepthLines(const RgbdCamera& camera) {
  YamlLines lines;
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

YamlLines OrbSlamLines(const RgbdCamera& rgbd, const std::string& prefix) {
  const Camera& camera = rgbd.camera;
  YamlLines lines;
  for (const CameraParameter& parameter : kCameraParameters) {
    lines.emplace_back(prefix + parameter.name,
                       Digits(camera.*parameter.value));
  }
  lines.emplace_back("Camera.width", std::to_string(camera.width));
  lines.emplace_back("Camera.height", std::to_string(camera.height));
  return lines;
}

// The keys of what is wrong with depth.
const std::vector<std::string>& DepthKeys() {
  static const std::vector<std::string> keys = {
      "inverse_depth_offset", "depth_time_offset", "depth_rotation",
      "depth_translation"};
  return keys;
}

YAML::Node ToNode(const std::vector<double>& values) {
  YAML::Node node;
  for (const double value : values) node.push_back(Digits(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

// The file written anew with other values; its comments are lost. `values` are
// those of ORB-SLAM's layout, none in the others.
std::string EditNodes(const RgbdCamera& rgbd, const std::string& text,
                      const YamlLines& values, YAML::Node file) {
  const Camera& c = rgbd.camera;
  if (!values.empty()) {
    for (const auto& [key, value] : values) {
      file.reset(With(file, key, YAML::Node(value)));
    }
  } else if (file["camera_matrix"].IsDefined()) {
    file.reset(
        With(file, "camera_matrix",
             With(file["camera_matrix"], "data",
                  ToNode({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}))));
    YAML::Node distortion = With(file["distortion_coefficients"], "data",
                                 ToNode({c.k1, c.k2, c.p1, c.p2, c.k3}));
    if (distortion["cols"].IsDefined()) {
      distortion.reset(With(distortion, "cols", YAML::Node(5)));
    }
    file.reset(With(file, "distortion_coefficients", distortion));
    // What a rectified image would be seen with is of the old camera.
    file.reset(Without(file, {"projection_matrix"}));
  } else {
    YAML::Node cam0 =
        With(file["cam0"], "intrinsics", ToNode({c.fx, c.fy, c.cx, c.cy}));
    cam0.reset(
        With(cam0, "distortion_coeffs", ToNode({c.k1, c.k2, c.p1, c.p2})));
    file.reset(With(file, "cam0", cam0));
  }
  const char* const scale = file["RGBD.DepthMapFactor"].IsDefined()
                                ? "RGBD.DepthMapFactor"
                                : "DepthMapFactor";
  file.reset(With(file, scale, YAML::Node(Digits(rgbd.depth_scale))));
  file.reset(Without(file, DepthKeys()));
  file.SetStyle(YAML::EmitterStyle::Block);
  // OpenCV's first line, which is no YAML.
  const bool is_of_opencv = text.rfind("%YAML", 0) == 0;
  std::string result = is_of_opencv ? "%YAML:1.0\n---\n" : "";
  result += YAML::Dump(file) + "\n";
  for (const auto& [key, value] : DepthLines(rgbd)) {
    result += key + ": " + value + "\n";
  }
  return result;
}

}  // namespace

std::string FormatCameraFile(const RgbdCamera& camera,
                             const std::string& like) {
  const bool is_preset = like.empty() || CameraPreset(like).has_value();
  std::string text = "%YAML:1.0\n";
  std::string prefix = "Camera.";
  std::string scale = "DepthMapFactor";
  YAML::Node file(YAML::NodeType::Map);
  if (!is_preset) {
    ResolveCamera(like);  // complains of what is wrong with it
    text = ReadTextFile(like);
    const YamlSection section = YamlSection::FromText(like, text);
    file.reset(section.node());
    if (section.HasKeyStartingWith("Camera1.")) prefix = "Camera1.";
    if (section.Has("RGBD.DepthMapFactor")) scale = "RGBD.DepthMapFactor";
    if (!section.Has(prefix + "fx")) return EditNodes(camera, text, {}, file);
  }
  YamlLines values = OrbSlamLines(camera, prefix);
  values.emplace_back(scale, Digits(camera.depth_scale));
  const std::optional<std::string> edited =
      EditLines(text, file, values, DepthKeys(), DepthLines(camera));
  return edited.has_value() ? *edited : EditNodes(camera, text, values, file);
}

}  // namespace rgbd_pose
