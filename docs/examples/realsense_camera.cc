// Odometry from a RealSense, by its own library.
#include <cstdio>
#include <librealsense2/rs.hpp>
#include <opencv2/imgproc.hpp>

#include "rgbd_pose/frontend/settings/settings.h"
#include "rgbd_pose/frontend/sources/latest_frame.h"

class RealSense final : public rgbd_pose::FrameSource {
 public:
  RealSense() : profile_(pipeline_.start()) {
    const auto stream = profile_.get_stream(RS2_STREAM_COLOR);
    const auto k = stream.as<rs2::video_stream_profile>().get_intrinsics();
    camera_.camera = {k.width, k.height, k.fx, k.fy, k.ppx, k.ppy};
    const auto sensor = profile_.get_device().first<rs2::depth_sensor>();
    camera_.depth_scale = 1.0 / sensor.get_depth_scale();
  }
  std::optional<rgbd_pose::RgbdFrame> Next() override {
    const rs2::frameset both = align_.process(pipeline_.wait_for_frames());
    const double time = 1e-3 * both.get_timestamp();  // s
    return rgbd_pose::RgbdFrame{
        time, [this, both, time] {
          const cv::Size size(camera_.camera.width, camera_.camera.height);
          auto* color = const_cast<void*>(both.get_color_frame().get_data());
          auto* depth = const_cast<void*>(both.get_depth_frame().get_data());
          rgbd_pose::Frame frame;
          frame.timestamp = time;
          frame.depth_scale = camera_.depth_scale;
          cv::cvtColor(cv::Mat(size, CV_8UC3, color), frame.gray,
                       cv::COLOR_RGB2GRAY);
          frame.depth = cv::Mat(size, CV_16UC1, depth).clone();
          return frame;
        }};
  }
  const rgbd_pose::RgbdCamera& camera() const override { return camera_; }

 private:
  rs2::pipeline pipeline_;
  rs2::pipeline_profile profile_;
  rs2::align align_{RS2_STREAM_COLOR};
  rgbd_pose::RgbdCamera camera_;
};

int main() {
  rgbd_pose::LatestFrame frames(std::make_unique<RealSense>());
  rgbd_pose::Odometry odometry = rgbd_pose::MakeOdometry({}, frames.camera());
  for (int i = 0; i < 900; ++i) {
    const auto tracked = odometry.Track(frames.Next()->read());
    const auto& at = tracked.world_from_cam.translation;
    std::printf("%.3f %.3f %.3f\n", at.x(), at.y(), at.z());
  }
  std::printf("%d frames came too fast\n", frames.dropped());
  return 0;
}
