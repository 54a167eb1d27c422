// Poses of recordings in numbered files: the input in each format.

#include "frontend/sources/numbered_layouts.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(numbered_poses) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  static const bool has_folder =
      std::filesystem::create_directory(folder.path() + "/pose");
  Require(has_folder, "a folder of poses");
  const std::string_view text = FuzzText(data, size);
  for (const char* name : {"frame-000001.pose.txt", "pose/1.txt", "traj.txt",
                           "traj_w_c.txt", "trajectory.log", "a.gt.freiburg"}) {
    folder.Write(name, text);
  }
  for (const NumberedLayout& layout : NumberedLayouts()) {
    MayRefuse([&] {
      const NumberedFolder frames = {
          folder.path(), {{1, "", ""}, {2, "", ""}, {3, "", ""}}, {1, 2, 3}};
      for (const auto& [number, pose] : layout.poses(frames)) {
        Require(number >= 1, "a number that an image can have");
        Require(pose.IsFinite(), "a pose that can be used");
      }
    });
  }
  return 0;
}
