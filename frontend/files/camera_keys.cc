#include "frontend/files/camera_keys.h"

#include <algorithm>
#include <vector>

#include "core/geometry/camera.h"
#include "core/util/nearest_name.h"
#include "core/util/text_file.h"
#include "frontend/files/imu_calibration_file.h"

namespace rgbd_pose {
namespace {

using Keys = std::vector<std::string>;

constexpr int kMaxCameras = 16;  // of a Kalibr file

// The keys at the top level that ReadCameraText reads.
Keys ReadAtTop() {
  Keys keys = {"DepthMapFactor",
               "RGBD.DepthMapFactor",
               "inverse_depth_offset",
               "depth_rotation",
               "depth_translation",
               "depth_noise",
               "Camera.type",
               "Camera.width",
               "Camera.height",
               "image_width",
               "image_height",
               "camera_matrix",
               "distortion_model",
               "distortion_coefficients",
               "width",
               "height",
               "intrinsic_matrix",
               "depth_scale"};
  for (const ShutterParameter& parameter : kShutterParameters) {
    keys.push_back(parameter.name);
  }
  for (const CameraParameter& parameter : kCameraParameters) {
    keys.push_back(std::string("Camera.") + parameter.name);
    keys.push_back(std::string("Camera1.") + parameter.name);
  }
  for (int i = 0; i < kMaxCameras; ++i) {
    keys.push_back("cam" + std::to_string(i));
  }
  const Keys of_imu = ImuKeys();
  keys.insert(keys.end(), of_imu.begin(), of_imu.end());
  return keys;
}

// Of a camera in a Kalibr file.
const Keys kReadInCamera = {
    "camera_model",      "intrinsics",       "T_cn_cnm1",
    "distortion_coeffs", "distortion_model", "resolution",
    "T_cam_imu",         "T_imu_cam",        "timeshift_cam_imu"};

// What other programs keep in these files: not read, and no mistake. A name
// that ends in a dot stands for all keys that begin with it.
const Keys kOfOtherPrograms = {
    // ORB-SLAM2 and 3
    "Camera.fps", "Camera.bf", "Camera.RGB", "Camera.newWidth",
    "Camera.newHeight", "Camera.imageScale", "Camera1.overlappingBegin",
    "Camera1.overlappingEnd", "Camera.lappingBegin", "Camera.lappingEnd",
    "Camera2.", "File.version", "IMU.fastInit", "IMU.Frequency",
    "IMU.InsertKFsWhenLost", "LEFT.", "loopClosing", "ORBextractor.", "RIGHT.",
    "Stereo.", "System.", "T_b_c1", "T_c1_c2", "ThDepth", "ThFarPoints", "Tlr",
    "Viewer.",
    // camera_info of ROS
    "binning_x", "binning_y", "camera_name", "frame_id", "header",
    "projection_matrix", "rectification_matrix", "roi",
    // Kalibr
    "cam_overlaps", "line_delay", "rostopic",
    // Kalibr's and EuRoC's inertial sensors
    "accelerometers", "comment", "gyroscopes", "imu0", "model", "rate_hz",
    "sensor_type", "T_BS", "T_i_b", "time_offset", "update_rate"};

bool IsOfOtherProgram(const std::string& key) {
  return std::any_of(kOfOtherPrograms.begin(), kOfOtherPrograms.end(),
                     [&key](const std::string& name) {
                       return name.back() == '.' ? key.rfind(name, 0) == 0
                                                 : key == name;
                     });
}

// The key that was probably meant. Behind a group that is right, as in
// Camera.fps, only the rest is compared.
std::string Meant(const std::string& key, const Keys& read) {
  const std::string group = key.substr(0, key.find('.') + 1);
  Keys rests;
  for (const std::string& name : read) {
    if (name.rfind(group, 0) == 0) rests.push_back(name.substr(group.size()));
  }
  const std::string rest = rests.empty() ? key : key.substr(group.size());
  const std::string nearest =
      NearestName(rest, rests.empty() ? read : rests,
                  std::min(2, static_cast<int>(rest.size()) / 3));
  return nearest.empty() || rests.empty() ? nearest : group + nearest;
}

// Adds the keys that nobody knows.
void Check(const YamlSection& section, const Keys& read,
           const std::string& files, Keys* unknown) {
  for (const std::string& key : section.Keys()) {
    if (std::count(read.begin(), read.end(), key) > 0) continue;
    if (key.empty() || IsOfOtherProgram(key)) continue;
    const std::string meant = Meant(key, read);
    if (!meant.empty()) {
      section.Fail(key,
                   "is no key of " + files + "; did you mean " + meant + "?");
    }
    unknown->push_back(key);
  }
}

}  // namespace

std::string WithSpellingOfKeys(const std::string& text) {
  std::string result;
  bool is_first = true;
  for (const std::string& line : SplitText(text, '\n')) {
    if (!is_first) result += '\n';
    is_first = false;
    const bool is_british = line.rfind("colour_", 0) == 0;
    result += is_british ? "color_" + line.substr(7) : line;
  }
  return result;
}

void CheckImuKeys(const YamlSection& file) {
  Keys unknown;
  const std::string files = "files of inertial sensors";
  Check(file, ReadAtTop(), files, &unknown);
  for (const char* name : {"imu0", "cam0"}) {
    if (!file.Has(name) || !file.node()[name].IsMap()) continue;
    Keys read = ImuKeys();
    read.insert(read.end(), kReadInCamera.begin(), kReadInCamera.end());
    Check(file.Child(name), read, files, &unknown);
  }
}

std::string CheckCameraKeys(const YamlSection& file) {
  Keys unknown;
  const std::string files = "camera files";
  Check(file, ReadAtTop(), files, &unknown);
  for (int i = 0; i < kMaxCameras; ++i) {
    const std::string name = "cam" + std::to_string(i);
    if (!file.Has(name) || !file.node()[name].IsMap()) continue;
    Keys of_camera;
    Check(file.Child(name), kReadInCamera, files, &of_camera);
    for (const std::string& key : of_camera)
      unknown.push_back(name + "." + key);
  }
  if (unknown.empty()) return "";
  return "unknown keys, which are not read: " + Join(unknown);
}

}  // namespace rgbd_pose
