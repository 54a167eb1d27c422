#include "frontend/sources/open_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/sources/imu_beside.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kAuto[] = "auto";

bool IsScale(double scale) { return std::isfinite(scale) && scale > 0.0; }

std::string ProblemOf(const CameraSetup& setup) {
  const std::string problem = setup.camera.Check();
  return !problem.empty() || IsScale(setup.depth_scale.value_or(1.0))
             ? problem
             : "the depth scale must be a positive number";
}

struct SourceType {
  std::string name;
  std::string what;  // description for messages
  std::function<bool(const SourceOptions& options)> recognises;
  std::function<std::unique_ptr<FrameSource>(const SourceOptions& options)>
      open;
};

bool HasFile(const SourceOptions& options, const char* name) {
  return PathExists(fs::path(options.path) / name);
}

SourceType BagType(BagKind kind, const char* name, const char* what) {
  return {name, what,
          [kind](const SourceOptions& options) {
            return IsBag(options.path, kind);
          },
          [kind](const SourceOptions& options) {
            return OpenBagSource(OpenBag(options.path, kind), options);
          }};
}

// A path is opened with the first type that recognises it.
const std::vector<SourceType>& Types() {
  static const std::vector<SourceType> types = [] {
    std::vector<SourceType> all = {
        {"tum", "TUM RGB-D (rgb.txt and depth.txt, or associations.txt)",
         [](const SourceOptions& options) {
           return (!options.associations_file.empty() &&
                   !fs::is_regular_file(options.path)) ||
                  HasFile(options, "rgb.txt") ||
                  HasFile(options, "depth.txt") ||
                  HasFile(options, "associations.txt");
         },
         OpenTum},
        BagType(BagKind::kRos1, "rosbag",
                "ROS 1 bag (.bag, also the RealSense viewer's, or a folder of "
                "NAME_0.bag, NAME_1.bag, ...)"),
        BagType(BagKind::kRos2, "rosbag2",
                "ROS 2 bag (.db3 or .mcap, or a folder of these)"),
        {"stray_scanner",
         "Stray Scanner (rgb.mp4, depth/, camera_matrix.csv, odometry.csv)",
         [](const SourceOptions& options) {
           return HasFile(options, "rgb.mp4") ||
                  HasFile(options, "camera_matrix.csv");
         },
         OpenStrayScanner},
        {"record3d", "Record3D (rgb/0.jpg, depth/0.exr, metadata.json)",
         [](const SourceOptions& options) {
           return HasFile(options, "metadata.json") &&
                  HasFile(options, "depth/0.exr");
         },
         OpenRecord3d},
        {"sun3d",
         "SUN3D, Redwood's scans (image/ or rgb/, and depth/ with "
         "0000001-000000033369.png: number and microseconds)",
         [](const SourceOptions& options) { return IsSun3d(options.path); },
         OpenSun3d},
        {"nerfstudio", "nerfstudio (transforms.json with depth_file_path)",
         [](const SourceOptions& options) {
           return IsNerfstudio(options.path);
         },
         OpenNerfstudio},
        // Never detected from a path.
        {"openni2", "OpenNI 2 camera (source=openni2, dataset=any)",
         [](const SourceOptions&) { return false; }, OpenOpenNi2},
    };
    for (const NumberedLayout& layout : NumberedLayouts()) {
      all.push_back({layout.name, layout.what,
                     [&layout](const SourceOptions& options) {
                       return IsNumbered(layout, options.path);
                     },
                     [&layout](const SourceOptions& options) {
                       return OpenNumbered(layout, options);
                     }});
    }
    return all;
  }();
  return types;
}

// Throws InputError for options that this kind of recording does not use.
void RequireUsed(const SourceType& type, const SourceOptions& options) {
  const bool is_bag = type.name == "rosbag" || type.name == "rosbag2";
  if (!options.topics.empty() && !is_bag) {
    throw InputError(options.path + ": topics are only for bags; this is " +
                     type.what + ": leave them out (--topics)");
  }
  if (!options.associations_file.empty() && type.name != "tum") {
    throw InputError(options.path +
                     ": an associations file is only for TUM folders; this "
                     "is " +
                     type.what + ": leave it out (--associations)");
  }
}

// The first few names in a folder, for a message.
std::string Content(const std::string& folder) {
  constexpr size_t kMaxNames = 6;
  std::set<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder, error)) {
    names.insert(entry.path().filename().string() +
                 (entry.is_directory(error) ? "/" : ""));
  }
  if (names.empty()) return "nothing";
  const size_t count = names.size();
  std::vector<std::string> some(names.begin(), names.end());
  some.resize(std::min(count, kMaxNames));
  return Join(some) + (count > kMaxNames ? ", ..." : "");
}

// What a path is, for a message; nothing if it is no recording.
std::optional<std::string> Recognised(SourceOptions options,
                                      const std::string& path) {
  options.path = path;
  for (const SourceType& type : Types()) {
    if (type.recognises(options)) return path + ", which is " + type.what;
  }
  return std::nullopt;
}

// The first recording in the folders of a folder, by name, down to some levels:
// archives often have a folder around it. Nothing if there is none.
std::optional<std::string> FindBelow(const SourceOptions& options,
                                     const std::string& path, int levels) {
  if (levels == 0) return std::nullopt;
  std::set<std::string> folders;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    if (entry.is_directory(error)) folders.insert(entry.path().string());
  }
  for (const std::string& folder : folders) {
    std::optional<std::string> found = Recognised(options, folder);
    if (!found.has_value()) found = FindBelow(options, folder, levels - 1);
    if (found.has_value()) return found;
  }
  return std::nullopt;
}

// The recording that a path was probably meant to name: it is below, or the
// path is a part of it, such as its folder of images.
std::optional<std::string> FindNear(const SourceOptions& options) {
  constexpr int kLevels = 2;
  const auto below = FindBelow(options, options.path, kLevels);
  if (below.has_value()) return below;
  const fs::path part_of = fs::path(options.path) / "..";
  const std::string above = part_of.lexically_normal().string();
  // Bags lie beside anything.
  const bool is_bag =
      IsBag(above, BagKind::kRos1) || IsBag(above, BagKind::kRos2);
  return is_bag ? std::nullopt : Recognised(options, above);
}

// Throws what a folder lacks that has numbered colour images without depth.
void RequireDepth(const SourceOptions& options) {
  for (const NumberedLayout& layout : NumberedLayouts()) {
    if (HasNumberedColor(layout, options.path)) OpenNumbered(layout, options);
  }
}

}  // namespace

std::string SourceOptions::Check() const {
  if (camera.has_value()) {
    const std::string problem = ProblemOf(*camera);
    if (!problem.empty()) return "camera: " + problem;
  }
  if (depth_scale != 0.0 && !IsScale(depth_scale)) {
    return "depth_scale must be positive (raw units per metre)";
  }
  if (!(max_time_difference >= 0.0)) {
    return "the time difference must not be negative";
  }
  return "";
}

CameraSetup ChooseCamera(const SourceOptions& options,
                         const std::optional<CameraSetup>& of_recording) {
  RequireSound(options.Check());
  if (!options.camera.has_value() && !of_recording.has_value()) {
    throw InputError(options.path +
                     ": contains no camera calibration; give one as camera "
                     "(--camera): a calibration file or one of the presets " +
                     Join(CameraPresetNames()));
  }
  CameraSetup chosen =
      options.camera.has_value() ? *options.camera : *of_recording;
  if (of_recording.has_value()) {
    if (!chosen.depth_scale) chosen.depth_scale = of_recording->depth_scale;
    if (!chosen.depth_camera) chosen.depth_camera = of_recording->depth_camera;
  }
  if (options.depth_scale > 0.0) chosen.depth_scale = options.depth_scale;
  const std::string problem = ProblemOf(chosen);
  if (!problem.empty()) {
    throw InputError(options.path + ": invalid camera: " + problem +
                     "; give a preset or a calibration file (camera)");
  }
  return chosen;
}

std::vector<std::string> SourceNames() {
  std::vector<std::string> names = {kAuto};
  for (const SourceType& type : Types()) names.push_back(type.name);
  return names;
}

std::unique_ptr<FrameSource> OpenSource(const std::string& name,
                                        const SourceOptions& options) {
  std::error_code error;
  std::string known;
  for (const SourceType& type : Types()) {
    if (name == kAuto ? type.recognises(options) : name == type.name) {
      RequireUsed(type, options);
      return WithImuBeside(type.open(options), options);
    }
    known += (known.empty() ? "" : "; ") + type.what;
  }
  if (name != kAuto) throw UnknownName("source", name, SourceNames());
  if (!PathExists(options.path)) {
    throw InputError(options.path + ": no such file or folder");
  }
  std::string problem = options.path + ": is not a supported recording";
  const bool is_folder = fs::is_directory(options.path, error);
  if (is_folder) problem += ": contains " + Content(options.path);
  if (const auto near = FindNear(options)) {
    throw InputError(problem + "; give " + *near);
  }
  RequireDepth(options);
  if (!is_folder) problem += "; if it is an archive, unpack it";
  throw InputError(problem + "; supported recordings: " + known +
                   (is_folder ? " (give bags of different recordings one at a "
                                "time)"
                              : ""));
}

}  // namespace rgbd_pose
