#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

// Reads the calibration of an RGB-D camera from a YAML file in one of the
// layouts that people already have:
//  - settings of ORB-SLAM2 and 3: Camera.fx (or Camera1.fx), fy, cx, cy, maybe
//    k1 k2 p1 p2 k3 k4 k5 k6; of Camera.type KannalaBrandt8 k1 k2 k3 k4;
//    Camera.width, Camera.height;
//  - ROS camera_info: image_width, image_height, camera_matrix.data (3 x 3),
//    distortion_coefficients.data (plumb_bob: k1 k2 p1 p2 and maybe k3;
//    rational_polynomial: k4 k5 k6, too; equidistant: k1 k2 k3 k4);
//  - Kalibr: cam0 with camera_model pinhole, intrinsics [fx fy cx cy],
//    distortion_model radtan with distortion_coeffs [k1 k2 p1 p2] or
//    equidistant with [k1 k2 k3 k4], resolution [width height].
// The depth scale is the top-level key DepthMapFactor or RGBD.DepthMapFactor
// (raw units per metre). Only ORB-SLAM writes it.
// `depth_camera` names the camera of a Kalibr file that depth images are seen
// from: cam0 if they are registered to colour, else cam1, say; each camera but
// cam0 has T_cn_cnm1, from the camera before. Empty: they are registered; a
// file of several cameras needs its name, though.
// Further top-level keys, absent: 0. When rows are exposed (s, see Shutter):
// color_time_offset, color_readout, depth_time_offset, depth_readout. What
// rgbd_calibrate found wrong with depth (see DepthCorrection):
// inverse_depth_offset (1/m), depth_rotation (rotation vector, rad),
// depth_translation (m). Throws InputError (file:line, key) for an unknown
// layout or camera model, a missing key, a wrong number of entries, and values
// that make no camera.
CameraSetup ReadCameraFile(const std::string& path,
                           const std::string& depth_camera = "");

// The same of the text of a file; `path` is for messages.
CameraSetup ReadCameraText(const std::string& text, const std::string& path,
                           const std::string& depth_camera = "");

// A camera by the name of its preset (see CameraPreset) or by its file. A file
// named like a preset is reached as ./name. Throws InputError, listing the
// presets, if it is neither.
CameraSetup ResolveCameraSetup(const std::string& file_or_preset,
                               const std::string& depth_camera = "");

// The same of a camera with registered depth. Without a depth scale it is 5000,
// as of the TUM RGB-D benchmark; many ROS drivers use 1000 instead.
RgbdCamera ResolveCamera(const std::string& file_or_preset);

// The text of a camera file (ReadCameraFile) for a camera, in the layout of
// another file, whose other keys stay: of a file in ORB-SLAM's layout its lines
// and comments too. `like`: that file; a preset's name, nothing, or a file that
// cannot hold the camera gives one in ORB-SLAM's layout. What is wrong with
// depth (RgbdCamera) has keys of its own. It reads as the camera that was
// given; where other keys of `like` were lost a comment says so. Throws
// InputError as ReadCameraFile does.
std::string FormatCameraFile(const RgbdCamera& camera, const std::string& like);

}  // namespace rgbd_pose
