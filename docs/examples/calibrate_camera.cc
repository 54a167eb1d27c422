// What is wrong with a camera, from what it sees as it is moved about.
#include <cstdio>
#include <vector>

#include "rgbd_pose/frontend/calibration/calibration_run.h"
#include "rgbd_pose/frontend/simulation/synthetic_dataset.h"

int main() {
  const rgbd_pose::SyntheticDataset room({"room", "handheld", 60});  // yours
  rgbd_pose::RgbdCamera camera = room.camera();
  camera.camera.fx *= 1.02;  // somebody was wrong by 2 %
  camera.camera.fy *= 1.02;

  // Keyframes that show the same, and the path between them.
  const auto odometry = rgbd_pose::CalibrationOdometry();
  rgbd_pose::Slam slam(odometry, rgbd_pose::CalibrationSlam(), camera);
  std::vector<rgbd_pose::SlamFrame> frames;
  for (int i = 0; i < room.size(); ++i) {
    frames.push_back(slam.Track(room.Read(i)));
  }
  slam.Finish();

  const rgbd_pose::CalibrationResult result =
      rgbd_pose::Calibrate(slam.Map(), rgbd_pose::SmoothPath(frames), camera,
                           odometry, {}, {}, /*threads=*/1);
  const rgbd_pose::CalibratedParameter& fx = result.parameters[rgbd_pose::kFx];
  std::printf("fx %.1f -> %.1f +- %.1f px: %s\n", fx.before, fx.found, fx.sigma,
              result.is_accepted ? "better" : result.reason.c_str());
  return 0;
}
