#include "frontend/files/camera_file.h"

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_keys.h"
#include "frontend/files/imu_calibration_file.h"
#include "frontend/files/yaml_section.h"

namespace rgbd_pose {
namespace {

// Name of the camera that depth is registered to, in all layouts.
constexpr char kColorCamera[] = "cam0";

bool IsOfColor(const std::string& depth_camera) {
  return depth_camera.empty() || depth_camera == kColorCamera;
}

Camera ReadOrbSlam(const YamlSection& file) {
  const std::string prefix =
      file.HasKeyStartingWith("Camera1.") ? "Camera1." : "Camera.";
  Camera camera;
  camera.width = file.Pixels("Camera.width");
  camera.height = file.Pixels("Camera.height");
  for (const auto& [name, value] : kCameraParameters) {
    const std::string key = prefix + name;
    const bool is_needed = name[0] == 'f' || name[0] == 'c';
    camera.*value = is_needed ? file.Number(key) : file.NumberOr(key, 0.0);
  }
  const std::string type =
      file.Word("Camera.type", {"PinHole", "Rectified", "KannalaBrandt8"});
  if (type == "KannalaBrandt8") camera.lens_model = LensModel::kEquidistant;
  return camera;
}

LensModel LensOf(const std::string& distortion_model) {
  return distortion_model == "equidistant" ? LensModel::kEquidistant
                                           : LensModel::kRational;
}

Camera ReadCameraInfoFile(const YamlSection& file) {
  const std::string model = file.Word(
      "distortion_model", {"plumb_bob", "rational_polynomial", "equidistant"});
  const int width = file.Pixels("image_width");
  const int height = file.Pixels("image_height");
  const YamlSection matrix = file.Child("camera_matrix");
  const std::vector<double> k = matrix.Numbers("data", {9});
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    matrix.Fail("data", "must read [fx 0 cx 0 fy cy 0 0 1], row by row");
  }
  Camera camera = {width, height, k[0], k[4], k[2], k[5]};
  const std::vector<size_t> counts =
      model == "equidistant" ? std::vector<size_t>{4}
      : model == "plumb_bob" ? std::vector<size_t>{4, 5}
                             : std::vector<size_t>{8};
  camera.SetDistortion(
      LensOf(model),
      file.Child("distortion_coefficients").Numbers("data", counts));
  return camera;
}

Camera ReadKalibr(const YamlSection& file, const std::string& name) {
  const YamlSection cam = file.Child(name);
  cam.Word("camera_model", {"pinhole"});
  const std::string model =
      cam.Word("distortion_model", {"radtan", "equidistant"});
  const std::vector<double> size = cam.Numbers("resolution", {2});
  const int width = cam.Pixels("resolution", size[0]);
  const int height = cam.Pixels("resolution", size[1]);
  const std::vector<double> k = cam.Numbers("intrinsics", {4});
  Camera camera = {width, height, k[0], k[1], k[2], k[3]};
  camera.SetDistortion(LensOf(model), cam.Numbers("distortion_coeffs", {4}));
  return camera;
}

DepthCamera ReadDepthCamera(const std::string& path, const YamlSection& file,
                            const std::string& name) {
  constexpr int kMaxCameras = 16;
  Rigid3d cam_from_color;
  for (int i = 1; i < kMaxCameras; ++i) {
    const std::string next = "cam" + std::to_string(i);
    if (!file.Has(next)) break;
    // T_cn_cnm1 is camera_from_previous.
    cam_from_color = file.Child(next).RigidMotion("T_cn_cnm1") * cam_from_color;
    if (next != name) continue;
    DepthCamera depth = {ReadKalibr(file, name), cam_from_color.Inverse()};
    RequireSound(depth.camera.Check(), path + ": " + name + ": ");
    return depth;
  }
  throw InputError(path + ": has no depth camera '" + name +
                   "'; give cam1 or a later one of a Kalibr file");
}

// Open3D: width, height and intrinsic_matrix, column by column; by hand it is
// often written row by row.
Camera ReadOpen3d(const YamlSection& file) {
  const std::vector<double> k = file.Numbers("intrinsic_matrix", {9});
  const bool is_by_rows = k[6] == 0.0 && k[7] == 0.0;
  return {file.Pixels("width"),  file.Pixels("height"), k[0], k[4],
          k[is_by_rows ? 2 : 6], k[is_by_rows ? 5 : 7]};
}

// The camera of images that are turned upside down.
Camera UpsideDown(Camera camera) {
  camera.fy = -camera.fy;
  camera.cy = camera.height - 1 - camera.cy;
  camera.p1 = -camera.p1;
  return camera;
}

Camera ReadAnyLayout(const std::string& path, const YamlSection& file) {
  if (file.HasKeyStartingWith("Camera.") ||
      file.HasKeyStartingWith("Camera1.")) {
    return ReadOrbSlam(file);
  }
  if (file.Has("camera_matrix")) return ReadCameraInfoFile(file);
  if (file.Has("cam0")) return ReadKalibr(file, "cam0");
  if (file.Has("intrinsic_matrix")) return ReadOpen3d(file);
  throw InputError(path +
                   ": contains no camera; supported layouts are ORB-SLAM "
                   "(Camera.fx), ROS camera_info (camera_matrix), Kalibr "
                   "(cam0) and Open3D (intrinsic_matrix)");
}

std::optional<double> ReadDepthScale(const YamlSection& file) {
  for (const char* key :
       {"DepthMapFactor", "RGBD.DepthMapFactor", "depth_scale"}) {
    if (!file.Has(key)) continue;
    const double scale = file.Number(key);
    if (scale < 1.0) {
      file.Fail(key,
                "must be raw depth units per metre, so at least 1 (5000 for "
                "the TUM benchmark, 1000 for millimetres); is it inverted?");
    }
    return scale;
  }
  return std::nullopt;
}

Eigen::Vector3d VectorOr0(const YamlSection& file, const std::string& key) {
  if (!file.Has(key)) return Eigen::Vector3d::Zero();
  return Eigen::Vector3d(file.Numbers(key, {3}).data());
}

// Larger values are errors in the file, perhaps of units.
void CheckSize(const YamlSection& file, const std::string& key, double size,
               double most, const std::string& unit) {
  if (size <= most) return;
  file.Fail(key, Format("must be at most %g ", most) + unit);
}

void ReadShutters(const YamlSection& file, RgbdCamera* camera) {
  for (const ShutterParameter& parameter : kShutterParameters) {
    double* const value = &(camera->*parameter.image.*parameter.value);
    *value = file.NumberOr(parameter.name, 0.0);
    CheckSize(file, parameter.name, std::abs(*value), parameter.most, "s");
    camera->color_shutter.is_known |= file.Has(parameter.name);
  }
}

DepthCorrection ReadDepthCorrection(const YamlSection& file) {
  DepthCorrection errors;
  errors.inverse_depth_offset = file.NumberOr("inverse_depth_offset", 0.0);
  CheckSize(file, "inverse_depth_offset", std::abs(errors.inverse_depth_offset),
            0.5, "1/m");
  const Eigen::Vector3d turn = VectorOr0(file, "depth_rotation");
  CheckSize(file, "depth_rotation", turn.norm(), 0.5, "rad");
  const Eigen::Vector3d translation = VectorOr0(file, "depth_translation");
  CheckSize(file, "depth_translation", translation.norm(), 0.5, "m");
  errors.depth_from_color = Rigid3d::FromRotationVector(turn, translation);
  return errors;
}

std::optional<DepthNoiseModel> ReadDepthNoise(const std::string& path,
                                              const YamlSection& file) {
  constexpr char kKey[] = "depth_noise";
  if (!file.Has(kKey)) return std::nullopt;
  const std::vector<double> values = file.Numbers(kKey, {4});
  DepthNoiseModel noise = {path, values[0], values[1], values[2], values[3]};
  if (const std::string error = noise.Check(); !error.empty()) {
    file.Fail(kKey, "(constant, quadratic, centre, mean_share): " + error);
  }
  CheckSize(file, kKey, noise.sigma(1.0), 1.0, "m for a depth of 1 m");
  return noise;
}

}  // namespace

RgbdCamera RegisteredCamera(const CameraSetup& setup) {
  return {setup.camera,
          setup.depth_scale.value_or(RgbdCamera{}.depth_scale),
          setup.depth_correction,
          setup.color_shutter,
          setup.depth_shutter,
          setup.depth_noise};
}

CameraSetup ReadCameraFile(const std::string& path,
                           const std::string& depth_camera) {
  return ReadCameraText(ReadTextFile(path), path, depth_camera);
}

CameraSetup ReadCameraText(const std::string& text, const std::string& path,
                           const std::string& depth_camera) {
  const YamlSection file =
      YamlSection::FromText(WithSpellingOfKeys(text), path);
  const std::string remark = CheckCameraKeys(file);
  RgbdCamera camera = {ReadAnyLayout(path, file)};
  const std::optional<double> depth_scale = ReadDepthScale(file);
  camera.depth_correction = ReadDepthCorrection(file);
  ReadShutters(file, &camera);
  camera.depth_noise = ReadDepthNoise(path, file);
  CameraSetup result(camera);
  result.depth_scale = depth_scale;
  result.imu = ReadImuCalibration(file);
  if (!remark.empty()) result.remark = path + ": " + remark;
  result.is_upside_down = result.camera.fy < 0.0;
  if (result.is_upside_down) {
    result.camera = UpsideDown(result.camera);
    const bool is_plain = IsOfColor(depth_camera) &&
                          camera.color_shutter.readout == 0.0 &&
                          camera.depth_shutter.readout == 0.0 &&
                          camera.depth_correction.depth_from_color.IsIdentity();
    if (!is_plain) {
      throw InputError(path +
                       ": fy < 0 is supported for registered depth without "
                       "readouts only; turn the images upside down");
    }
  }
  RequireSound(result.camera.Check(), path + ": ");
  if (depth_camera.empty() && file.Has("cam0") && file.Has("cam1")) {
    throw InputError(path +
                     ": has several cameras; choose that of the depth images: "
                     "give this file as camera, with depth_camera cam1, or "
                     "cam0 if depth is registered to colour");
  }
  if (!IsOfColor(depth_camera)) {
    result.depth_camera = ReadDepthCamera(path, file, depth_camera);
  }
  return result;
}

CameraSetup ResolveCameraSetup(const std::string& file_or_preset,
                               const std::string& depth_camera) {
  const auto preset = CameraPreset(file_or_preset);
  if (!preset && PathExists(file_or_preset)) {
    return ReadCameraFile(file_or_preset, depth_camera);
  }
  if (!preset) {
    throw InputError("camera '" + file_or_preset +
                     "' is neither a file nor one of the presets: " +
                     Join(CameraPresetNames()));
  }
  if (!IsOfColor(depth_camera)) {
    throw InputError("camera '" + file_or_preset +
                     "' is a preset and has no depth camera '" + depth_camera +
                     "'; give a Kalibr file of both cameras");
  }
  // Presets have registered depth. Their depth scale, which comes from the
  // benchmark, is dropped: the scale of a recording takes precedence.
  CameraSetup setup(*preset);
  setup.depth_scale.reset();
  return setup;
}

RgbdCamera ResolveCamera(const std::string& file_or_preset) {
  const CameraSetup setup = ResolveCameraSetup(file_or_preset, kColorCamera);
  if (setup.is_upside_down) {
    throw InputError(file_or_preset +
                     ": fy < 0: only recordings are turned upside down; turn "
                     "images of your own, and give fy > 0");
  }
  return RegisteredCamera(setup);
}

}  // namespace rgbd_pose
