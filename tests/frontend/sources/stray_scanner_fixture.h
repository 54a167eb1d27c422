#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <opencv2/videoio.hpp>
#include <string>

#include "core/util/format.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/sources/open_source.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {

inline constexpr int kVideoWidth = 1280;
inline constexpr int kVideoHeight = 960;
inline constexpr int kDepthWidth = 256;  // as ARKit's
inline constexpr int kDepthHeight = 192;
inline constexpr char kStrayHeader[] =
    "timestamp, frame, x, y, z, qx, qy, qz, qw";

// A camera of this width. All have the same view, magnified by `focus`.
inline Camera PhoneCamera(int width, double focus = 1.0) {
  const double scale = width / 1280.0;
  return {width,
          width * 3 / 4,
          1066.0 * scale * focus,
          1066.0 * scale * focus,
          (638.2 + 0.5) * scale - 0.5,
          (481.7 + 0.5) * scale - 0.5};
}

inline SyntheticOptions Phone(int frames, double focus = 1.0) {
  SyntheticOptions options;
  options.path = "handheld";
  options.frames = frames;
  options.noise = false;
  options.camera = {PhoneCamera(kVideoWidth, focus), 1000.0};
  options.depth_camera =
      DepthCamera{PhoneCamera(kDepthWidth, focus), Rigid3d()};
  return options;
}

// A row of odometry.csv.
inline std::string StrayRowText(double timestamp, int number,
                                const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return Format("%.6f, %06d, %.9f, %.9f, %.9f, %.9f, %.9f, %.9f, %.9f",
                timestamp, number, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                q.w());
}

// Writes recordings as the app does, and reads them.
class StrayScannerTest : public testing::Test {
 protected:
  StrayScannerTest() {
    const Camera camera = PhoneCamera(kVideoWidth);
    folder_.Write("camera_matrix.csv",
                  Format("%.4f, 0.0, %.4f\n0.0, %.4f, %.4f\n0.0, 0.0, 1.0",
                         camera.fx, camera.cx, camera.fy, camera.cy));
  }

  // Writes colour, depth and pose of so many frames as the app does.
  void Record(int frames, const std::function<Frame(int)>& read,
              const std::function<Rigid3d(int)>& pose) {
    cv::VideoWriter video(folder_ / "rgb.mp4", cv::CAP_FFMPEG,
                          cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 60.0,
                          {kVideoWidth, kVideoHeight});
    ASSERT_TRUE(video.isOpened());
    std::string rows = std::string(kStrayHeader) + "\n";
    for (int k = 0; k < frames; ++k) {
      const Frame frame = read(k);
      video << frame.color;
      WriteDepth(k, frame.depth);
      rows += StrayRowText(frame.timestamp, k, pose(k)) + "\n";
    }
    folder_.Write("odometry.csv", rows);
  }
  void Record(const SyntheticDataset& scene) {
    Record(
        scene.size(), [&](int k) { return scene.Read(k); },
        [&](int k) { return scene.WorldFromCam(k); });
  }
  // Images of one grey level each, 2 m away.
  void RecordPlain(int frames) {
    Record(
        frames,
        [](int k) {
          Frame frame;
          frame.timestamp = 100.0 + k / 60.0;
          frame.color = cv::Mat(kVideoHeight, kVideoWidth, CV_8UC3, Level(k));
          frame.depth = cv::Mat(kDepthHeight, kDepthWidth, CV_16UC1, 2000);
          return frame;
        },
        [](int) { return Rigid3d(); });
  }
  static cv::Scalar Level(int k) { return cv::Scalar::all(30 + 10 * k); }

  void WriteDepth(int k, const cv::Mat& depth) {
    WriteImage(folder_ / Format("depth/%06d.png", k), depth);
    WriteImage(folder_ / Format("confidence/%06d.png", k),
               cv::Mat(depth.size(), CV_8UC1, cv::Scalar(2)));
  }

  std::unique_ptr<FrameSource> Open() const {
    SourceOptions options;
    options.path = folder_.path();
    options.keep_color = true;
    return OpenSource("auto", options);
  }
  Frame First() const { return Open()->Next()->read(); }

  TempFolder folder_;
};

}  // namespace rgbd_pose
