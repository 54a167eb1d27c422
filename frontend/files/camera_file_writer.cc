#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/camera_keys.h"
#include "frontend/files/yaml_section.h"

namespace rgbd_pose {
namespace {

using YamlLines =
    std::vector<std::pair<std::string, std::string>>;  // key, value

// The keys that are the same in all layouts, see RgbdLines.
constexpr const char* kRgbdKeys[] = {"color_time_offset",    "color_readout",
                                     "depth_time_offset",    "depth_readout",
                                     "inverse_depth_offset", "depth_rotation",
                                     "depth_translation",    "depth_noise"};

std::string List(const Eigen::VectorXd& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(ShortNumber(value));
  return "[" + Join(texts) + "]";
}

// As in the list of a camera file; zeros if the noise is unknown.
Eigen::Vector4d NoiseOf(const RgbdCamera& camera) {
  if (!camera.depth_noise.has_value()) return Eigen::Vector4d::Zero();
  const DepthNoiseModel& noise = *camera.depth_noise;
  return {noise.constant, noise.quadratic, noise.centre, noise.mean_share};
}

// The lines with these keys.
std::string RgbdLines(const RgbdCamera& camera) {
  std::string lines;
  const auto add = [&lines](const std::string& key, const std::string& value) {
    lines += key + ": " + value + "\n";
  };
  for (const ShutterParameter& parameter : kShutterParameters) {
    const double value = camera.*parameter.image.*parameter.value;
    if (value != 0.0 || camera.color_shutter.is_known) {
      add(parameter.name, ShortNumber(value));
    }
  }
  const double offset = camera.depth_correction.inverse_depth_offset;
  if (offset != 0.0) add("inverse_depth_offset", ShortNumber(offset));
  const Rigid3d& moved = camera.depth_correction.depth_from_color;
  if (!moved.IsIdentity()) {
    add("depth_rotation", List(RotationVector(moved.rotation)));
    add("depth_translation", List(moved.translation));
  }
  if (camera.depth_noise.has_value()) add("depth_noise", List(NoiseOf(camera)));
  return lines;
}

// The index of the line of a key, if it is within `lines`.
std::optional<size_t> LineOf(const YAML::Node& file, const std::string& key,
                             const std::vector<std::string>& lines) {
  for (const auto& entry : file) {
    if (entry.first.Scalar() != key) continue;
    const size_t line = entry.first.Mark().line;
    if (line < lines.size()) return line;
  }
  return std::nullopt;
}

// Replaces values in the text of a file and keeps all other lines. `file` is
// the parsed text. Missing keys of `values` are added unless they are 0, and
// the lines of kRgbdKeys are replaced by RgbdLines. The result is correct only
// if each of these keys has a line of its own, without an anchor.
std::string EditLines(const std::string& text, const YAML::Node& file,
                      const YamlLines& values, const RgbdCamera& camera) {
  std::stringstream in(text);
  std::vector<std::string> lines;  // with their ends
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(line + "\n");
  }
  size_t last = 0;  // the last changed line
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
        (comment == std::string::npos ? "\n" : lines[*line].substr(comment));
    last = std::max(last, *line);
  }
  for (const char* const key : kRgbdKeys) {
    if (const auto line = LineOf(file, key, lines)) lines[*line].clear();
  }
  lines[last] += added + RgbdLines(camera);
  return Join(lines, "");
}

// Sets the value of a key, or removes the key if the value is null. Builds a
// new map and leaves the old one unchanged, as other keys may refer to it.
template <typename Value>
void Set(YAML::Node* map, const std::string& key, const Value& value) {
  const YAML::Node node(value);
  YAML::Node result(YAML::NodeType::Map);
  result.SetStyle(map->Style());
  bool is_done = node.IsNull();
  for (const auto& entry : *map) {
    const bool is_it = entry.first.Scalar() == key;
    if (is_it && is_done) continue;  // only the first one counts
    result.force_insert(entry.first, is_it ? node : entry.second);
    is_done |= is_it;
  }
  if (!is_done) result.force_insert(key, node);
  map->reset(result);
}

YamlLines OrbSlamLines(const Camera& camera, const std::string& prefix) {
  YamlLines lines;
  for (const auto& [name, value] : kCameraParameters) {
    lines.emplace_back(prefix + name, ShortNumber(camera.*value));
  }
  if (camera.lens_model == LensModel::kEquidistant) {
    lines.emplace_back("Camera.type", "\"KannalaBrandt8\"");
  }
  lines.emplace_back("Camera.width", std::to_string(camera.width));
  lines.emplace_back("Camera.height", std::to_string(camera.height));
  return lines;
}

YAML::Node ToNode(const std::vector<double>& values) {
  YAML::Node node;
  for (const double value : values) node.push_back(ShortNumber(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

// Writes the parsed file with new `values` and, in the layouts of ROS and
// Kalibr, with the camera in their nested keys. Comments are lost.
std::string EditNodes(const RgbdCamera& rgbd, const std::string& text,
                      const YamlLines& values, bool is_of_orb_slam,
                      YAML::Node file) {
  const Camera& c = rgbd.camera;
  const std::vector<double> coefficients = c.Distortion();
  const bool is_equidistant = c.lens_model == LensModel::kEquidistant;
  for (const auto& [key, value] : values) Set(&file, key, value);
  if (!is_of_orb_slam && file["camera_matrix"].IsDefined()) {
    Set(&file, "image_width", c.width);
    Set(&file, "image_height", c.height);
    YAML::Node matrix = file["camera_matrix"];
    Set(&matrix, "data",
        ToNode({c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}));
    Set(&file, "camera_matrix", matrix);
    YAML::Node distortion = file["distortion_coefficients"];
    Set(&distortion, "data", ToNode(coefficients));
    if (distortion["cols"].IsDefined()) {
      Set(&distortion, "cols", coefficients.size());
    }
    Set(&file, "distortion_coefficients", distortion);
    Set(&file, "distortion_model",
        is_equidistant             ? "equidistant"
        : coefficients.size() == 5 ? "plumb_bob"
                                   : "rational_polynomial");
    // The projection matrix of rectified images is of the old camera.
    Set(&file, "projection_matrix", YAML::Node());
  } else if (!is_of_orb_slam) {
    YAML::Node cam0 = file["cam0"];
    Set(&cam0, "intrinsics", ToNode({c.fx, c.fy, c.cx, c.cy}));
    // If radtan cannot hold all coefficients, Says returns false later.
    Set(&cam0, "distortion_coeffs",
        ToNode({coefficients.begin(), coefficients.begin() + 4}));
    Set(&cam0, "distortion_model", is_equidistant ? "equidistant" : "radtan");
    Set(&cam0, "resolution",
        ToNode({static_cast<double>(c.width), static_cast<double>(c.height)}));
    Set(&file, "cam0", cam0);
  }
  for (const char* const key : kRgbdKeys) Set(&file, key, YAML::Node());
  file.SetStyle(YAML::EmitterStyle::Block);
  // The first line of OpenCV's files, which is not valid YAML.
  const bool is_of_opencv = text.rfind("%YAML", 0) == 0;
  const std::string result = is_of_opencv ? "%YAML:1.0\n---\n" : "";
  return result + YAML::Dump(file) + "\n" + RgbdLines(rgbd);
}

// Whether reading a text gives this camera.
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
  const auto has_known_times = [](const RgbdCamera& c) {
    return c.color_shutter.is_known || !c.color_shutter.IsGlobal() ||
           !c.depth_shutter.IsGlobal();
  };
  for (const auto& [name, value] : kCameraParameters) {
    if (!is_same(read.camera.*value, camera.camera.*value)) return false;
  }
  for (const auto& [name, image, value, most] : kShutterParameters) {
    if (!is_same(read.*image.*value, camera.*image.*value)) return false;
  }
  const DepthCorrection& errors = read.depth_correction;
  const DepthCorrection& wanted = camera.depth_correction;
  const Rigid3d between =
      errors.depth_from_color.Inverse() * wanted.depth_from_color;
  return read.camera.lens_model == camera.camera.lens_model &&
         read.camera.width == camera.camera.width &&
         read.camera.height == camera.camera.height &&
         has_known_times(read) == has_known_times(camera) &&
         is_same(read.depth_scale, camera.depth_scale) &&
         is_same(errors.inverse_depth_offset, wanted.inverse_depth_offset) &&
         is_same((NoiseOf(read) - NoiseOf(camera)).norm(), 0.0) &&
         is_same(between.Angle(), 0.0) &&
         is_same(between.translation.norm(), 0.0);
}

// The file `like` with the values of a camera, if its layout can hold it.
std::optional<std::string> Edited(const RgbdCamera& camera,
                                  const std::string& like) {
  ResolveCamera(like);  // throws if the file has errors
  const std::string text = WithSpellingOfKeys(ReadTextFile(like));
  const YamlSection file = YamlSection::FromText(text, like);
  const std::string prefix =
      file.HasKeyStartingWith("Camera1.") ? "Camera1." : "Camera.";
  // If both keys exist, the reader uses DepthMapFactor.
  const char* const scale =
      file.Has("RGBD.DepthMapFactor") && !file.Has("DepthMapFactor")
          ? "RGBD.DepthMapFactor"
          : "DepthMapFactor";
  const bool is_of_orb_slam = file.Has(prefix + "fx");
  YamlLines values;
  if (is_of_orb_slam) values = OrbSlamLines(camera.camera, prefix);
  values.emplace_back(scale, ShortNumber(camera.depth_scale));
  if (is_of_orb_slam) {
    const std::string lines = EditLines(text, file.node(), values, camera);
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
        "# The layout of the original file cannot represent this camera.\n"
        "# Other entries of that file are not included.\n";
  }
  YamlLines values = OrbSlamLines(camera.camera, "Camera.");
  values.emplace_back("DepthMapFactor", ShortNumber(camera.depth_scale));
  const std::string first = "%YAML:1.0\n";
  std::string text =
      EditLines(first, YAML::Node(YAML::NodeType::Map), values, camera);
  return text.insert(first.size(), why);
}

}  // namespace rgbd_pose
