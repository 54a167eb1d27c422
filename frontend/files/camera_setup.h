#pragma once

#include <optional>

#include "core/geometry/camera.h"
#include "frontend/frame/depth_registration.h"

namespace rgbd_pose {

// What is known of an RGB-D camera, by a calibration file or by a recording.
struct CameraSetup {
  CameraSetup() = default;
  explicit CameraSetup(const Camera& color) : camera(color) {}

  // With its depth scale as it is there.
  CameraSetup(const RgbdCamera& rgbd)  // NOLINT(*-explicit-*): says the same
      : camera(rgbd.camera),
        depth_scale(rgbd.depth_scale),
        depth_correction(rgbd.depth_correction),
        color_shutter(rgbd.color_shutter),
        depth_shutter(rgbd.depth_shutter) {}

  Camera camera;  // of the colour image

  // Raw units of the depth image per metre; nothing: not said.
  std::optional<double> depth_scale;

  DepthCorrection depth_correction;  // of the depth images, once registered

  // See RgbdCamera.
  Shutter color_shutter;
  Shutter depth_shutter;  // likewise

  // Nothing: the depth images are registered to colour.
  std::optional<DepthCamera> depth_camera;
};

// As it is once depth is registered. Without a depth scale it is the one of
// RgbdCamera, 5000.
RgbdCamera RegisteredCamera(const CameraSetup& setup);

}  // namespace rgbd_pose
