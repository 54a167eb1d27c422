#include "frontend/sources/numbered_layouts.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/yaml_section.h"
#include "frontend/sources/camera_matrix.h"
#include "frontend/sources/numbered_paths.h"
#include "frontend/sources/sensor_info.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// The first of some files that exists in a folder; empty: none.
fs::path FirstOf(const fs::path& folder,
                 std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (PathExists(folder / name)) return folder / name;
  }
  return {};
}

// intrinsic.json, or the file name of Open3D's recorder or of its samples.
std::optional<CameraSetup> Open3dCamera(const NumberedFolder& folder) {
  const fs::path path = FirstOf(
      folder.path,
      {"intrinsic.json", "camera_intrinsic.json", "camera_primesense.json"});
  if (path.empty()) return std::nullopt;
  return ReadCameraFile(path.string());
}

// cam_params.json of the folder, or of its parent for all rooms.
std::optional<CameraSetup> ReplicaCamera(const NumberedFolder& folder) {
  for (const char* name : {"cam_params.json", "../cam_params.json"}) {
    const fs::path path = folder.path / name;
    if (!PathExists(path)) continue;
    const YamlSection file =
        YamlSection::FromFile(path.string()).Child("camera");
    CameraSetup setup(Camera{file.Pixels("w"), file.Pixels("h"),
                             file.Number("fx"), file.Number("fy"),
                             file.Number("cx"), file.Number("cy")});
    if (file.Has("scale")) setup.depth_scale = file.Number("scale");
    return setup;
  }
  return std::nullopt;
}

// ScanNet's exporter writes the identity. Any other matrix contains real
// extrinsics, but in an undocumented convention, and is refused.
void RequireIdentity(const fs::path& file) {
  if (!PathExists(file)) return;
  const std::string path = file.string();
  const std::vector<TextLine> lines = ReadTextTable(path);
  for (size_t row = 0; row < lines.size(); ++row) {
    for (size_t column = 0; column < lines[row].words.size(); ++column) {
      const double value = ParseNumber(lines[row].words[column], path,
                                       lines[row].number, "extrinsics");
      if (std::abs(value - (row == column ? 1.0 : 0.0)) > 1e-6) {
        throw InputError(path + ":" + std::to_string(lines[row].number) +
                         ": must be the identity, as in ScanNet's exports; "
                         "give both cameras as a Kalibr file (camera, "
                         "depth_camera)");
      }
    }
  }
}

// Two cameras of different image sizes, assumed to be at the same place.
std::optional<CameraSetup> ScanNetCamera(const NumberedFolder& folder) {
  const fs::path intrinsic = folder.path / "intrinsic";
  const NumberedFrame& first = folder.frames.front();
  CameraSetup setup(ReadCameraMatrix(
      (intrinsic / "intrinsic_color.txt").string(), first.color_path));
  RequireIdentity(intrinsic / "extrinsic_color.txt");
  RequireIdentity(intrinsic / "extrinsic_depth.txt");
  const fs::path of_depth = intrinsic / "intrinsic_depth.txt";
  if (PathExists(of_depth)) {
    setup.depth_camera = DepthCamera{
        ReadCameraMatrix(of_depth.string(), first.depth_path), Rigid3d()};
  }
  return setup;
}

// Appends the numbers of a line to a 4 x 4 matrix, row by row. In a lost frame
// they are infinite or NaN, here always NaN.
void AddNumbers(const TextLine& line, const std::string& path,
                std::vector<double>* matrix) {
  for (const std::string& word : line.words) {
    if (matrix->size() == 16) {
      throw InputError(path, line.number, "has more than 4 x 4 numbers");
    }
    const bool is_lost =
        word == "-inf" || word == "inf" || word == "nan" || word == "-nan";
    matrix->push_back(is_lost ? NAN
                              : ParseNumber(word, path, line.number, "pose"));
  }
}

// Stores the pose of a 4 x 4 matrix unless its frame is lost.
void AddPose(const std::vector<double>& m, int number, const std::string& path,
             int line, NumberedPoses* poses) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(
      m.data());
  if (!matrix.allFinite()) return;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  // Tolerates values with few digits.
  const double error =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(error < 0.05) || !(rotation.determinant() > 0.0)) {
    throw InputError(path, line,
                     "not a pose: the upper left 3 x 3 is not a rotation");
  }
  (*poses)[number] = Rigid3d(Eigen::Quaterniond(rotation), {m[3], m[7], m[11]});
}

// One file per frame, by a pattern of NumberedPaths: 4 rows of 4 numbers; -inf
// for a lost frame (7-Scenes, ScanNet).
NumberedPoses ReadPoseFiles(const NumberedFolder& folder, const char* pattern) {
  const auto paths = NumberedPaths(folder.path.string(), {pattern});
  NumberedPoses poses;
  for (const NumberedFrame& frame : folder.frames) {
    const auto found = paths.find(frame.number);
    if (found == paths.end()) continue;
    const std::string& path = found->second;
    // Infinite or NaN as Windows writes it, where # begins no comment.
    if (ReadTextFile(path).find("1.#") != std::string::npos) continue;
    std::vector<double> matrix;
    for (const TextLine& line : ReadTextTable(path)) {
      AddNumbers(line, path, &matrix);
    }
    if (matrix.size() < 16) {
      throw InputError(path + ": needs 4 rows of 4 numbers");
    }
    AddPose(matrix, frame.number, path, 1, &poses);
  }
  return poses;
}

NumberedPoses ReadFramePoses(const NumberedFolder& folder) {
  return ReadPoseFiles(folder, "frame-*.pose.txt");
}

// The number of the image that the i-th of `count` poses belongs to: the i-th
// image if there are as many. Otherwise images are missing, and i counts from
// their first number, 0 or 1.
int NumberOf(const NumberedFolder& folder, size_t i, size_t count) {
  const std::vector<int>& numbers = folder.numbers;
  if (count == numbers.size() && i < count) return numbers[i];
  return static_cast<int>(i) + (numbers.front() == 1 ? 1 : 0);
}

// A file with the poses of all frames, in order: each has a head line of `head`
// words, unless this is 0, and its matrix in `rows` rows.
NumberedPoses ReadPoseTable(const NumberedFolder& folder, const char* name,
                            size_t head, size_t rows) {
  const std::string path = (folder.path / name).string();
  NumberedPoses poses;
  if (!PathExists(path)) return poses;
  const std::vector<TextLine> lines = ReadTextTable(path);
  const size_t first = head > 0 ? 1 : 0, each = first + rows;
  for (size_t i = 0; i < lines.size(); i += each) {
    std::vector<double> matrix;
    for (size_t k = 0; k < each; ++k) {
      const TextLine& line = lines[std::min(i + k, lines.size() - 1)];
      const size_t expected = k < first ? head : 16 / rows;
      if (i + k >= lines.size() || line.words.size() != expected) {
        throw InputError(path, line.number,
                         Format("needs %zu numbers here (lines for each pose: "
                                "%zu)",
                                expected, each));
      }
      if (k >= first) AddNumbers(line, path, &matrix);
    }
    AddPose(matrix, NumberOf(folder, i / each, lines.size() / each), path,
            lines[i].number, &poses);
  }
  return poses;
}

}  // namespace

const std::vector<NumberedLayout>& NumberedLayouts() {
  static const std::vector<NumberedLayout> layouts = {
      {"7scenes",
       "7-Scenes (frame-000000.color.png, .depth.png, .pose.txt)",
       {"frame-*.color.png"},
       {"frame-*.depth.png"},
       1000.0,
       ReadFramePoses,
       nullptr,
       "",
       "7scenes"},
      {"bundlefusion",
       "BundleFusion, 12-Scenes, 3RScan (frame-000000.color.jpg, .depth.png or "
       ".depth.pgm, .pose.txt, info.txt)",
       {"frame-*.color.jpg"},
       {"frame-*.depth.png", "frame-*.depth.pgm"},
       1000.0,
       ReadFramePoses,
       [](const NumberedFolder& folder) {
         return ReadSensorInfo(folder.path);
       }},
      {"scannet",
       "ScanNet as exported (color/0.jpg, depth/0.png, pose/0.txt, intrinsic/)",
       {"color/*.jpg", "color/*.png"},
       {"depth/*.png"},
       1000.0,
       [](const NumberedFolder& folder) {
         return ReadPoseFiles(folder, "pose/*.txt");
       },
       ScanNetCamera,
       "intrinsic/intrinsic_color.txt"},
      {"replica",
       "Replica as NICE-SLAM ships it (results/frame000000.jpg, "
       "depth000000.png, traj.txt)",
       {"results/frame*.jpg", "results/frame*.png"},
       {"results/depth*.png"},
       6553.5,
       [](const NumberedFolder& folder) {
         return ReadPoseTable(folder, "traj.txt", 0, 1);
       },
       ReplicaCamera},
      {"semantic_nerf",
       "Replica as Semantic-NeRF and vMAP ship it (rgb/rgb_0.png, "
       "depth/depth_0.png, traj_w_c.txt)",
       {"rgb/rgb_*.png"},
       {"depth/depth_*.png"},
       1000.0,
       [](const NumberedFolder& folder) {
         return ReadPoseTable(folder, "traj_w_c.txt", 0, 1);
       }},
      {"frame_pairs",
       "images beside each other (frame_00000_rgb.png, frame_00000_depth.png, "
       "or 00000-color.png, 00000-depth.png)",
       {"frame_*_rgb.png", "frame_*_rgb.jpg", "frame_*_color.png",
        "frame_*_color.jpg", "*-color.png", "*-color.jpg"},
       {"frame_*_depth.png", "*-depth.png"},
       1000.0,
       [](const NumberedFolder& folder) {
         return ReadPoseTable(folder, "trajectory.log", 3, 4);
       }},
      {"open3d",
       "Open3D, Redwood (color/, rgb/ or image/, and depth/ with numbered "
       "images, intrinsic.json)",
       {"color/*.jpg", "color/*.png", "rgb/*.jpg", "rgb/*.png", "image/*.jpg",
        "image/*.png"},
       {"depth/*.png"},
       1000.0,
       [](const NumberedFolder& folder) {
         return ReadPoseTable(folder, "trajectory.log", 3, 4);
       },
       Open3dCamera},
  };
  return layouts;
}

std::optional<CameraSetup> NumberedCamera(const NumberedLayout& layout,
                                          const NumberedFolder& folder) {
  if (layout.camera != nullptr) {
    std::optional<CameraSetup> own = layout.camera(folder);
    if (own.has_value()) return own;
  }
  // 3DMatch has one for all recordings of a scene, above them.
  const fs::path text =
      FirstOf(folder.path,
              {"camera-intrinsics.txt", "camera_intrinsics.txt",
               "intrinsics.txt", "intrinsic.txt", "../camera-intrinsics.txt"});
  if (text.empty()) return std::nullopt;
  return CameraSetup(
      ReadCameraMatrix(text.string(), folder.frames.front().color_path));
}

std::vector<double> NumberedTimes(const NumberedFolder& folder) {
  const fs::path file =
      FirstOf(folder.path, {"timestamps.txt", "timestamp.txt", "times.txt"});
  if (file.empty()) return {};
  const std::string path = file.string();
  std::vector<double> times;
  for (const TextLine& line : ReadTextTable(path)) {
    const double time = ParseTimestamp(line.words.back(), path, line.number);
    if (!times.empty() && time <= times.back()) {
      throw InputError(path, line.number,
                       "the time is not after that of the previous line");
    }
    times.push_back(time);
  }
  if (times.size() != folder.numbers.size()) {
    throw InputError(path + Format(": has %zu times, but there are %zu colour "
                                   "images; they must be one for one",
                                   times.size(), folder.numbers.size()));
  }
  return times;
}

}  // namespace rgbd_pose
