// Camera files (YAML) in all layouts.

#include <cmath>
#include <string>

#include "frontend/files/camera_file.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace rgbd_pose;

RgbdCamera ReadAgain(const std::string& file) {
  try {
    return ResolveCamera(file);
  } catch (const InputError&) {
    Require(false, "a camera file that can be read again");
  }
  return {};
}

void RequireEqual(const RgbdCamera& a, const RgbdCamera& b) {
  const auto require = [](double x, double y) {
    Require(std::abs(x - y) <= 1e-6 * (1.0 + std::abs(y)),
            "a camera that is written as it is");
  };
  for (const CameraParameter& parameter : kCameraParameters) {
    require(a.camera.*parameter.value, b.camera.*parameter.value);
  }
  require(a.camera.width, b.camera.width);
  require(a.camera.height, b.camera.height);
  require(a.depth_scale, b.depth_scale);
}

}  // namespace

FUZZ_TARGET(camera_file) {
  static const FuzzFolder folder;
  const std::string file = folder.Write("camera.yaml", FuzzText(data, size));
  MayRefuse([&] {
    const CameraSetup camera = ReadCameraFile(file, "cam0");
    Require(camera.camera.Check().empty(), "a camera that can be used");
    const double scale = camera.depth_scale.value_or(1.0);
    Require(std::isfinite(scale) && scale >= 1.0,
            "a depth scale that can be used");
    camera.camera.Unproject({0.0, 0.0}, 1.0);
    const RgbdCamera registered = RegisteredCamera(camera);
    const std::string again =
        folder.Write("again.yaml", FormatCameraFile(registered, file));
    RequireEqual(ReadAgain(again), registered);
  });
  MayRefuse([&] {
    const CameraSetup rig = ReadCameraFile(file, "cam1");
    Require(rig.depth_camera->camera.Check().empty() &&
                rig.depth_camera->color_from_depth.IsFinite(),
            "a depth camera that can be used");
  });
  return 0;
}
