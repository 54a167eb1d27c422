// Camera files (YAML) in all layouts.

#include <cmath>

#include "frontend/sources/camera_file.h"
#include "tests/fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("camera.yaml", FuzzText(data, size));
  MayRefuse([&] {
    const RgbdCamera camera = ReadCameraFile(file);
    Require(camera.camera.Check().empty(), "a camera that can be used");
    Require(std::isfinite(camera.depth_scale) && camera.depth_scale >= 1.0,
            "a depth scale that can be used");
    camera.camera.Unproject({0.0, 0.0}, 1.0);
  });
  return 0;
}
