// Trajectories and ground truth (TUM text).

#include <cmath>

#include "core/evaluation/trajectory.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(trajectory) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("trajectory.txt", FuzzText(data, size));
  MayRefuse([&] {
    const Trajectory trajectory = ReadTrajectory(file);
    Require(!trajectory.empty(), "at least one pose");
    for (size_t i = 0; i < trajectory.size(); ++i) {
      const Rigid3d& pose = trajectory[i].world_from_cam;
      Require(i == 0 || trajectory[i].timestamp > trajectory[i - 1].timestamp,
              "poses in strict time order");
      Require(std::isfinite(pose.translation.norm()), "a finite position");
      Require(std::abs(pose.rotation.norm() - 1.0) < 1e-9, "a rotation");
    }
    FormatTrajectory(trajectory);
  });
  return 0;
}
