#pragma once

#include <optional>
#include <string>

#include "core/geometry/camera.h"
#include "core/inertial/imu_calibration.h"
#include "frontend/frame/depth_registration.h"

namespace rgbd_pose {

// An RGB-D camera as described by a calibration file or a recording.
struct CameraSetup {
  CameraSetup() = default;
  explicit CameraSetup(const Camera& color) : camera(color) {}

  // Keeps the depth scale.
  CameraSetup(const RgbdCamera& rgbd)  // NOLINT(*-explicit-*): says the same
      : camera(rgbd.camera),
        depth_scale(rgbd.depth_scale),
        depth_correction(rgbd.depth_correction),
        color_shutter(rgbd.color_shutter),
        depth_shutter(rgbd.depth_shutter),
        depth_noise(rgbd.depth_noise) {}

  Camera camera;  // of the colour image

  // Raw units of the depth image per metre; nothing if unknown.
  std::optional<double> depth_scale;

  DepthCorrection depth_correction;  // see RgbdCamera
  Shutter color_shutter;             // see RgbdCamera
  Shutter depth_shutter;             // see RgbdCamera

  std::optional<DepthNoiseModel> depth_noise;  // see RgbdCamera

  // Nothing if the depth images are registered to colour.
  std::optional<DepthCamera> depth_camera;

  // Of the inertial sensor beside the camera, as far as it is known.
  ImuCalibration imu;

  // Whether images must be turned upside down before they fit `camera`: the y
  // axis of the calibration points up (fy < 0), as in ICL-NUIM. Paths are then
  // in the world of the recording, which is a mirror image.
  bool is_upside_down = false;

  // What users should know about the file, in one line: unknown keys.
  std::string remark;
};

// The camera after depth is registered, by default with the depth scale 5000 of
// the TUM RGB-D benchmark; many ROS drivers use 1000 instead.
RgbdCamera RegisteredCamera(const CameraSetup& setup);

// Reads the calibration of an RGB-D camera from a YAML file in one of these
// common layouts:
//  - settings of ORB-SLAM2 and 3: Camera.fx (or Camera1.fx), fy, cx, cy and
//    optionally k1 k2 p1 p2 k3 k4 k5 k6 (k1 k2 k3 k4 for the Camera.type
//    KannalaBrandt8); Camera.width, Camera.height;
//  - ROS camera_info: image_width, image_height, camera_matrix.data (3 x 3),
//    distortion_coefficients.data (plumb_bob: k1 k2 p1 p2 and optionally k3;
//    rational_polynomial: also k4 k5 k6; equidistant: k1 k2 k3 k4);
//  - Kalibr: cam0 with camera_model pinhole, intrinsics [fx fy cx cy],
//    distortion_model radtan with distortion_coeffs [k1 k2 p1 p2] or
//    equidistant with [k1 k2 k3 k4], resolution [width height].
// Top-level keys of all layouts: DepthMapFactor or RGBD.DepthMapFactor (raw
// depth units per metre); with the default 0 exposure times of rows (s, see
// Shutter), color_time_offset, color_readout, depth_time_offset, depth_readout,
// and errors of depth (see DepthCorrection), inverse_depth_offset (1/m),
// depth_rotation (rotation vector, rad), depth_translation (m); depth_noise, a
// list of constant (m), quadratic (1/m), centre (m) and mean_share of a
// DepthNoiseModel; ImuKeys(). Keys that start with colour_ are read as well. A
// key that is nearly one of these is an error; all others are named in the
// remark.
// `depth_camera` is the name of the depth camera in a Kalibr file: cam0 if
// depth is registered to colour, otherwise a later one. These have T_cn_cnm1,
// the transform from the camera before. Empty: registered, but an error for a
// file with several cameras. Throws InputError (file:line, key) for all else.
CameraSetup ReadCameraFile(const std::string& path,
                           const std::string& depth_camera = "");

// The same for the text of a file; `path` is used in error messages.
CameraSetup ReadCameraText(const std::string& text, const std::string& path,
                           const std::string& depth_camera = "");

// The camera of a preset (CameraPreset) or of a file; ./name is always a file.
// Throws InputError, which lists the presets, if the argument is neither.
CameraSetup ResolveCameraSetup(const std::string& file_or_preset,
                               const std::string& depth_camera = "");

// The same for a camera with registered depth.
RgbdCamera ResolveCamera(const std::string& file_or_preset);

// The text of a camera file that is read as this camera. The file `like` gives
// the layout and all other keys; in ORB-SLAM's layout its lines and comments
// are kept as well. If `like` is empty, a preset or a file that cannot hold the
// camera, the layout is ORB-SLAM's; for such a file a comment says that other
// keys were lost. Throws InputError as ReadCameraFile does.
std::string FormatCameraFile(const RgbdCamera& camera, const std::string& like);

}  // namespace rgbd_pose
