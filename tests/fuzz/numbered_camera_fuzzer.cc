// Cameras of recordings in numbered files: the input as each kind of file.

#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/open_source.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(numbered_camera) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  static const bool has_folder =
      std::filesystem::create_directory(folder.path() + "/intrinsic");
  Require(has_folder, "a folder of cameras");
  for (const char* name : {"camera_intrinsic.json", "cam_params.json",
                           "info.txt", "intrinsic/intrinsic_color.txt"}) {
    folder.Write(name, FuzzText(data, size));
  }
  for (const NumberedLayout& layout : NumberedLayouts()) {
    if (layout.camera == nullptr) continue;
    MayRefuse([&] {
      SourceOptions options;
      options.path = folder.path();
      const CameraSetup setup = ChooseCamera(
          options, layout.camera({folder.path(), {NumberedFrame()}, {0}}));
      Require(setup.camera.Check().empty(), "a camera that can be used");
    });
  }
  return 0;
}
