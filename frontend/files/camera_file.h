#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

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
// The depth scale is the top-level key DepthMapFactor or RGBD.DepthMapFactor
// (raw units per metre). Only ORB-SLAM writes it.
// `depth_camera` is the name of the depth camera in a Kalibr file: cam0 if
// depth is registered to colour, otherwise cam1, for example. Each camera but
// cam0 has T_cn_cnm1, the transform from the camera before it. Empty means that
// depth is registered, but is an error for a file with several cameras. Further
// top-level keys default to 0. Exposure times of rows (s, see Shutter):
// color_time_offset, color_readout, depth_time_offset, depth_readout. Errors of
// depth found by rgbd_calibrate (see DepthCorrection): inverse_depth_offset
// (1/m), depth_rotation (rotation vector, rad), depth_translation (m).
// Throws InputError (file:line, key) for an unknown layout or camera model, a
// missing key, a wrong number of entries, and values of no valid camera.
CameraSetup ReadCameraFile(const std::string& path,
                           const std::string& depth_camera = "");

// The same for the text of a file; `path` is used in error messages.
CameraSetup ReadCameraText(const std::string& text, const std::string& path,
                           const std::string& depth_camera = "");

// The camera of a preset (see CameraPreset) or of a file. A file that has the
// name of a preset is reached as ./name. Throws InputError, which lists the
// presets, if the argument is neither.
CameraSetup ResolveCameraSetup(const std::string& file_or_preset,
                               const std::string& depth_camera = "");

// The same for a camera with registered depth. The default depth scale is 5000,
// as in the TUM RGB-D benchmark; many ROS drivers use 1000 instead.
RgbdCamera ResolveCamera(const std::string& file_or_preset);

// The text of a camera file (see ReadCameraFile) for a camera. The file `like`
// gives the layout and all other keys; in ORB-SLAM's layout its lines and
// comments are kept as well. If `like` is empty, a preset or a file that cannot
// hold the camera, the layout is ORB-SLAM's; for such a file a comment says
// that other keys were lost. The depth correction has its own keys. Reading the
// text gives the same camera. Throws InputError as ReadCameraFile does.
std::string FormatCameraFile(const RgbdCamera& camera, const std::string& like);

}  // namespace rgbd_pose
