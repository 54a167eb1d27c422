// Camera files (YAML) in all layouts.

#include <cmath>

#include "frontend/files/camera_file.h"
#include "tests/fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("camera.yaml", FuzzText(data, size));
  MayRefuse([&] {
    const CameraSetup camera = ReadCameraFile(file, "cam0");
    Require(camera.camera.Check().empty(), "a camera that can be used");
    const double scale = camera.depth_scale.value_or(1.0);
    Require(std::isfinite(scale) && scale >= 1.0,
            "a depth scale that can be used");
    camera.camera.Unproject({0.0, 0.0}, 1.0);
  });
  MayRefuse([&] {
    const CameraSetup rig = ReadCameraFile(file, "cam1");
    Require(rig.depth_camera->camera.Check().empty() &&
                rig.depth_camera->color_from_depth.IsFinite(),
            "a depth camera that can be used");
  });
  return 0;
}
