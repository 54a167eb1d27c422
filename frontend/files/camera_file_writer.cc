#include "frontend/files/camera_file_writer.h"

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/camera.h"
#include "core/util/input_error.h"
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
YamlLines RgbdLines(const RgbdCamera& camera) {
  YamlLines lines;
  const auto add = [&lines](const char* key, double value, bool is_said) {
    if (value != 0.0 || is_said) lines.emplace_back(key, Digits(value));
  };
  for (const ShutterParameter& parameter : kShutterParameters) {
    add(parameter.name, camera.*parameter.image.*parameter.value,
        camera.color_shutter.is_known);
  }
  add("inverse_depth_offset", camera.depth_correction.inverse_depth_offset,
      false);
  const Rigid3d& moved = camera.depth_correction.depth_from_color;
  if (!moved.IsIdentity()) {
    lines.emplace_back("depth_rotation",
                       List(ToList(RotationVector(moved.rotation))));
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
  if (camera.lens_model == LensModel::kEquidistant) {
    lines.emplace_back("Camera.type", "\"KannalaBrandt8\"");
  }
  lines.emplace_back("Camera.width", std::to_string(camera.width));
  lines.emplace_back("Camera.height", std::to_string(camera.height));
  return lines;
}

// Their names.
const std::vector<std::string>& RgbdKeys() {
  static const std::vector<std::string> keys = {
      "color_time_offset", "color_readout",        "depth_time_offset",
      "depth_readout",     "inverse_depth_offset", "depth_rotation",
      "depth_translation"};
  return keys;
}

YAML::Node ToNode(const std::vector<double>& values) {
  YAML::Node node;
  for (const double value : values) node.push_back(Digits(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

// The file written again with the values of some keys, and in ROS' or Kalibr's
// layout with those of the camera below theirs; its comments are lost.
std::string EditNodes(const RgbdCamera& rgbd, const std::string& text,
                      const YamlLines& values, bool is_of_orb_slam,
                      YAML::Node file) {
  const Camera& c = rgbd.camera;
  const std::vector<double> coefficients = c.Distortion();
  const bool is_equidistant = c.lens_model == LensModel::kEquidistant;
  for (const auto& [key, value] : values) {
    file.reset(With(file, key, YAML::Node(value)));
  }
  if (is_of_orb_slam) {
    // These keys have none below.
  } else if (file["camera_matrix"].IsDefined()) {
    file.reset(With(file, "image_width", YAML::Node(c.width)));
    file.reset(With(file, "image_height", YAML::Node(c.height)));
    file.reset(
        With(file, "camera_matrix",
             With(file["camera_matrix"], "data",
                  ToNode({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}))));
    YAML::Node distortion =
        With(file["distortion_coefficients"], "data", ToNode(coefficients));
    if (distortion["cols"].IsDefined()) {
      distortion.reset(
          With(distortion, "cols", YAML::Node(coefficients.size())));
    }
    file.reset(With(file, "distortion_coefficients", distortion));
    const char* const model = is_equidistant ? "equidistant"
                              : coefficients.size() == 5
                                  ? "plumb_bob"
                                  : "rational_polynomial";
    file.reset(With(file, "distortion_model", YAML::Node(model)));
    // What a rectified image would be seen with is of the old camera.
    file.reset(Without(file, {"projection_matrix"}));
  } else {
    YAML::Node cam0 =
        With(file["cam0"], "intrinsics", ToNode({c.fx, c.fy, c.cx, c.cy}));
    // What a radtan cannot hold is missed by Says.
    cam0.reset(With(cam0, "distortion_coeffs",
                    ToNode({coefficients.begin(), coefficients.begin() + 4})));
    cam0.reset(With(cam0, "distortion_model",
                    YAML::Node(is_equidistant ? "equidistant" : "radtan")));
    cam0.reset(With(
        cam0, "resolution",
        ToNode({static_cast<double>(c.width), static_cast<double>(c.height)})));
    file.reset(With(file, "cam0", cam0));
  }
  file.reset(Without(file, RgbdKeys()));
  file.SetStyle(YAML::EmitterStyle::Block);
  // OpenCV's first line, which is no YAML.
  const bool is_of_opencv = text.rfind("%YAML", 0) == 0;
  std::string result = is_of_opencv ? "%YAML:1.0\n---\n" : "";
  result += YAML::Dump(file) + "\n";
  for (const auto& [key, value] : RgbdLines(rgbd)) {
    result += key + ": " + value + "\n";
  }
  return result;
}

// Whether a text reads as that camera.
bool Says(const std::string& text, const RgbdCamera& camera) {
  RgbdCamera read;
  try {
    read = RegisteredCamera(ReadCameraText(text, "", "cam0"));
  } catch (const InputError&) {
    return false;
  }
  const auto is_same = [](double a, double b) {
    return std::abs(a - b) <= 1e-8 * (1.0 + std::abs(b));
  };
  const auto are_times_known = [](const RgbdCamera& rgbd) {
    return rgbd.color_shutter.is_known || !rgbd.color_shutter.IsGlobal() ||
           !rgbd.depth_shutter.IsGlobal();
  };
  const auto is_same_shutter = [&](const Shutter& a, const Shutter& b) {
    return is_same(a.offset, b.offset) && is_same(a.readout, b.readout);
  };
  for (const CameraParameter& parameter : kCameraParameters) {
    if (!is_same(read.camera.*parameter.value,
                 camera.camera.*parameter.value)) {
      return false;
    }
  }
  const DepthCorrection &a = read.depth_correction,
                        &b = camera.depth_correction;
  const Rigid3d between = a.depth_from_color.Inverse() * b.depth_from_color;
  return read.camera.lens_model == camera.camera.lens_model &&
         read.camera.width == camera.camera.width &&
         read.camera.height == camera.camera.height &&
         is_same(read.depth_scale, camera.depth_scale) &&
         is_same(a.inverse_depth_offset, b.inverse_depth_offset) &&
         is_same_shutter(read.color_shutter, camera.color_shutter) &&
         is_same_shutter(read.depth_shutter, camera.depth_shutter) &&
         are_times_known(read) == are_times_known(camera) &&
         is_same(between.Angle(), 0.0) &&
         is_same(between.translation.norm(), 0.0);
}

// The file `like` with the values of a camera; nothing if that cannot be said
// in this file.
std::optional<std::string> Edited(const RgbdCamera& camera,
                                  const std::string& like) {
  ResolveCamera(like);  // complains of what is wrong with it
  const std::string text = ReadTextFile(like);
  const YamlSection file = YamlSection::FromText(text, like);
  const std::string prefix =
      file.HasKeyStartingWith("Camera1.") ? "Camera1." : "Camera.";
  // The reader's order, where both are there.
  const char* const scale =
      file.Has("RGBD.DepthMapFactor") && !file.Has("DepthMapFactor")
          ? "RGBD.DepthMapFactor"
          : "DepthMapFactor";
  const bool is_of_orb_slam = file.Has(prefix + "fx");
  YamlLines values;
  if (is_of_orb_slam) values = OrbSlamLines(camera, prefix);
  values.emplace_back(scale, Digits(camera.depth_scale));
  if (is_of_orb_slam) {
    const std::string lines =
        EditLines(text, file.node(), values, RgbdKeys(), RgbdLines(camera));
    if (Says(lines, camera)) return lines;
  }
  const std::string rewritten =
      EditNodes(camera, text, values, is_of_orb_slam, file.node());
  return Says(rewritten, camera) ? std::optional(rewritten) : std::nullopt;
}

}  // namespace

std::string FormatCameraFile(const RgbdCamera& camera,
                             const std::string& like) {
  std::string why;
  if (!like.empty() && !CameraPreset(like).has_value()) {
    const std::optional<std::string> edited = Edited(camera, like);
    if (edited.has_value()) return *edited;
    why =
        "# In another layout than the file before, which could not hold this "
        "camera:\n# what else was in there is not here.\n";
  }
  YamlLines values = OrbSlamLines(camera, "Camera.");
  values.emplace_back("DepthMapFactor", Digits(camera.depth_scale));
  const std::string first = "%YAML:1.0\n";
  std::string text = EditLines(first, YAML::Node(YAML::NodeType::Map), values,
                               {}, RgbdLines(camera));
  return text.insert(first.size(), why);
}

}  // namespace rgbd_pose
