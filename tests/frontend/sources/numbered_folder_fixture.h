#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "frontend/sources/open_source.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {

inline constexpr int kFrames = 3;

// Half a turn around y, and a step to the right for each frame.
inline std::string PoseText(int k, const char* end_of_row) {
  const std::string end = end_of_row;
  return "-1 0 0 " + std::to_string(k) + end + "0 1 0 0.5" + end + "0 0 -1 2" +
         end + "0 0 0 1" + end;
}

inline void ExpectPose(const Rigid3d& pose, int k) {
  EXPECT_NEAR(pose.Angle(), M_PI, 1e-9);
  EXPECT_LT((pose.translation - Eigen::Vector3d(k, 0.5, 2.0)).norm(), 1e-12);
  EXPECT_LT((pose * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(k - 1, 2.5, -1))
                .norm(),
            1e-9);
}

// The intrinsics of SmallCamera() in a file of ScanNet.
inline constexpr char kMatrix[] =
    "30 0 15.5 0\n0 30 11.5 0\n0 0 1 0\n0 0 0 1\n";

inline std::string Padded(int k) {
  const std::string digits = std::to_string(k);
  return std::string(6 - digits.size(), '0') + digits;
}

// A folder of numbered images, written by a test.
class NumberedFolderTest : public testing::Test {
 protected:
  void Write(const std::string& name, const cv::Mat& image) {
    WriteImage(folder_ / name, image);
  }
  void WriteText(const std::string& name, const std::string& text) {
    folder_.Write(name, text);
  }
  SourceOptions Options() const {
    SourceOptions options;
    options.path = folder_.path();
    return options;
  }
  SourceOptions WithCamera() const {
    SourceOptions options = Options();
    options.camera = CameraSetup(SmallCamera().camera);
    return options;
  }

  // Reads the sequence and compares it with what was written.
  std::unique_ptr<FrameSource> ExpectRead(const std::string& name,
                                          const SourceOptions& options,
                                          double depth_scale) {
    auto source = OpenSource("auto", options);
    EXPECT_EQ(OpenSource(name, options)->timestamps(), source->timestamps());
    EXPECT_EQ(source->camera().depth_scale, depth_scale);
    EXPECT_EQ(source->camera().camera.width, kWidth);
    for (int k = 0; k < kFrames; ++k) {
      const std::optional<RgbdFrame> next = source->Next();
      EXPECT_TRUE(next.has_value());
      if (!next.has_value()) break;
      const Frame frame = next->read();
      EXPECT_EQ(frame.index, k);
      EXPECT_NEAR(frame.timestamp, k / 30.0, 1e-12);
      EXPECT_EQ(frame.depth_delay, 0.0);
      EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000 + k);
      EXPECT_NEAR(frame.gray.at<uint8_t>(5, 5), 68 + k, 3);
    }
    EXPECT_FALSE(source->Next().has_value());
    return source;
  }

  void ExpectPoses(const FrameSource& source, int count = kFrames) {
    const Trajectory truth = source.ground_truth();
    ASSERT_EQ(truth.size(), static_cast<size_t>(count));
    for (int k = 0; k < count; ++k) {
      EXPECT_NEAR(truth[k].timestamp, k / 30.0, 1e-12);
      ExpectPose(truth[k].world_from_cam, k);
    }
  }

  void WriteSevenScenes() {
    for (int k = 0; k < kFrames; ++k) {
      const std::string stem = "frame-" + Padded(k);
      Write(stem + ".color.png", ColorImage(k));
      Write(stem + ".depth.png", DepthImage(k));
      WriteText(stem + ".pose.txt", PoseText(k, "\t\n"));
    }
  }

  TempFolder folder_;
};

}  // namespace rgbd_pose
