#pragma once

#include <optional>

#include "core/geometry/camera.h"
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
        depth_shutter(rgbd.depth_shutter) {}

  Camera camera;  // of the colour image

  // Raw units of the depth image per metre; nothing if unknown.
  std::optional<double> depth_scale;

  DepthCorrection depth_correction;  // of the depth images, once registered

  // See RgbdCamera.
  Shutter color_shutter;
  Shutter depth_shutter;

  // Nothing if the depth images are registered to colour.
  std::optional<DepthCamera> depth_camera;
};

// The camera after depth is registered. The default depth scale is that of
// RgbdCamera, 5000.
RgbdCamera RegisteredCamera(const CameraSetup& setup);

}  // namespace rgbd_pose
