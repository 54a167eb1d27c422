// Odometry frame by frame, in the loop of your own camera.
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "rgbd_pose/frontend/settings/settings.h"
#include "rgbd_pose/frontend/simulation/synthetic_dataset.h"
#include "rgbd_pose/frontend/sources/frame_assembly.h"

int main() {
  const rgbd_pose::SyntheticDataset camera({"room", "pan_tilt", 60});  // yours
  const rgbd_pose::OdometrySettings settings;
  rgbd_pose::Odometry odometry =
      rgbd_pose::MakeOdometry(settings, camera.camera());
  rgbd_pose::Frame frame;  // its memory serves for all of them
  for (int i = 0; i < camera.size(); ++i) {
    const rgbd_pose::Frame images = camera.Read(i);
    frame.index = i;
    frame.timestamp = i / 30.0;  // s
    cv::cvtColor(images.color, frame.gray, cv::COLOR_BGR2GRAY);
    frame.depth = images.depth;
    frame.depth_scale = 5000.0;  // units per metre
    // The shutters and the depth errors of the camera, if its file states any.
    frame = rgbd_pose::CorrectDepth(camera.camera(), frame);
    const rgbd_pose::TrackedFrame tracked = odometry.Track(frame);
    if (!tracked.reason.empty())
      std::printf("%d: %s\n", i, tracked.reason.c_str());
  }
  const double error = odometry.WorldFromCam().translation.norm();
  std::printf("back at the start within %.2f mm\n", 1e3 * error);
  return 0;
}
