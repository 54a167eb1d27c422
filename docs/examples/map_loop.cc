// A map of what your camera sees, kept, and the path corrected in it.
#include <cstdio>

#include "rgbd_pose/core/util/input_error.h"
#include "rgbd_pose/frontend/simulation/synthetic_dataset.h"
#include "rgbd_pose/frontend/slam/map_folder.h"
#include "rgbd_pose/frontend/slam/slam.h"

int main() {
  const rgbd_pose::SyntheticDataset camera({"room", "pan_tilt", 60});  // yours
  const rgbd_pose::OdometrySettings settings;
  rgbd_pose::Slam slam(settings, {}, camera.camera());
  for (int i = 0; i < camera.size(); ++i) {
    const rgbd_pose::SlamFrame frame = slam.Track(camera.Read(i));
    // frame.odom_from_cam never jumps; frame.map_from_cam() is corrected.
    if (frame.loops > 0) std::printf("%d closes a loop\n", i);
  }
  slam.Finish();
  const rgbd_pose::Trajectory path = slam.Path();  // map_from_cam, at the end
  try {
    rgbd_pose::SaveMap("map", slam.Map());  // Load(LoadMap("map"), ...) reads
  } catch (const rgbd_pose::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  const rgbd_pose::Rigid3d moved =
      path.front().world_from_cam.Inverse() * path.back().world_from_cam;
  std::printf("%zu keyframes, back at the start within %.2f mm\n",
              slam.Map().keyframes.size(), 1e3 * moved.translation.norm());
  return 0;
}
