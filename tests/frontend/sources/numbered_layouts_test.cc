#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "tests/frontend/sources/numbered_folder_fixture.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

using NumberedLayoutsTest = NumberedFolderTest;

TEST_F(NumberedLayoutsTest, ReadsSevenScenes) {
  WriteSevenScenes();
  ExpectPoses(*ExpectRead("7scenes", WithCamera(), 1000.0));
}

// Identity extrinsics, and the intrinsics of SmallCamera().
std::string SensorInfo(const std::string& extrinsics) {
  const std::string matrix =
      "Intrinsic = 30 0 15.5 0 0 30 11.5 0 0 0 1 0 0 0 0 1 \n";
  return "m_sensorName = StructureSensor\n"
         "m_colorWidth = 32\nm_colorHeight = 24\n"
         "m_depthWidth = 32\nm_depthHeight = 24\nm_depthShift = 2000\n"
         "m_calibrationColor" +
         matrix + "m_calibrationDepth" + matrix +
         "m_calibrationDepthExtrinsic = " + extrinsics;
}

TEST_F(NumberedLayoutsTest, ReadsBundleFusion) {
  for (int k = 0; k < kFrames; ++k) {
    const std::string stem = "data/frame-" + Padded(k);
    Write(stem + ".color.jpg", ColorImage(k));
    Write(stem + ".depth.png", DepthImage(k));
    WriteText(stem + ".pose.txt", PoseText(k, "\n"));
  }
  SourceOptions options = Options();
  options.path = folder_ / "data";
  ExpectInputError([&] { OpenSource("auto", options); },
                   {"contains no camera calibration"});
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 \n";
  WriteText("info.txt", SensorInfo(identity));  // where 12-Scenes has it
  auto source = ExpectRead("bundlefusion", options, 2000.0);
  EXPECT_EQ(source->camera().camera.fx, 30.0);
  EXPECT_EQ(source->camera().camera.cy, 11.5);
  EXPECT_EQ(source->camera().color_shutter.readout, 0.0) << "no Kinect";
  ExpectPoses(*source);

  // Lost, as Windows writes it.
  WriteText("data/frame-000002.pose.txt", "-1.#INF -1.#INF -1.#INF -1.#INF\n");
  ExpectPoses(*OpenSource("auto", options), 2);

  const auto expect_bad_info = [&](const std::string& text,
                                   const std::string& problem) {
    WriteText("data/_info.txt", text);
    ExpectInputError([&] { OpenSource("auto", options); },
                     {"data/_info.txt", problem});
  };
  expect_bad_info("made by hand\n", "has no m_calibrationColorIntrinsic");
  expect_bad_info("m_calibrationColorIntrinsic = 1\n", ":1: ");
  expect_bad_info("m_colorWidth = 1e300\n" + SensorInfo(identity),
                  ":1: m_colorWidth must be a number of pixels");
  expect_bad_info(SensorInfo("1 0 0 0.1 0 1 0 0 0 0 1 0 0 0 0 1\n"),
                  "m_calibrationDepthExtrinsic must be the identity");
}

TEST_F(NumberedLayoutsTest, ReadsDepthAs3RScanHasIt) {
  Write("frame-000000.color.jpg", ColorImage(0));
  std::string pgm = "P5\n32 24\n65535\n";  // with the high byte first
  for (int i = 0; i < kWidth * kHeight; ++i) pgm += "\x03\xE8";  // 1000
  WriteText("frame-000000.depth.pgm", pgm);
  const Frame frame = OpenSource("bundlefusion", WithCamera())->Next()->read();
  EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000);
}

TEST_F(NumberedLayoutsTest, ReadsScanNet) {
  for (int k = 0; k < kFrames; ++k) {
    const std::string number = std::to_string(k);
    Write("color/" + number + ".jpg", ColorImage(k));
    Write("depth/" + number + ".png", DepthImage(k));
    WriteText("pose/" + number + ".txt", PoseText(k, "\n"));
  }
  WriteText("intrinsic/intrinsic_color.txt", kMatrix);
  WriteText("intrinsic/intrinsic_depth.txt", kMatrix);
  const std::string nowhere = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  WriteText("intrinsic/extrinsic_color.txt", nowhere);
  WriteText("intrinsic/extrinsic_depth.txt", nowhere);
  const auto source = ExpectRead("scannet", Options(), 1000.0);
  EXPECT_EQ(source->camera().camera.fx, 30.0);
  EXPECT_EQ(source->camera().camera.cy, 11.5);
  ExpectPoses(*source);

  // The last frame is lost.
  WriteText("pose/2.txt",
            "-inf -inf -inf -inf\n-inf -inf -inf -inf\n"
            "-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
  ExpectPoses(*OpenSource("auto", Options()), 2);
}

// As some scripts write them.
TEST_F(NumberedLayoutsTest, ReadsPosesOfScanNetWithLeadingZeros) {
  for (int k = 0; k < kFrames; ++k) {
    Write("color/" + Padded(k) + ".jpg", ColorImage(k));
    Write("depth/" + Padded(k) + ".png", DepthImage(k));
    WriteText("pose/" + Padded(k) + ".txt", PoseText(k, "\n"));
  }
  WriteText("intrinsic/intrinsic_color.txt", kMatrix);
  ExpectPoses(*ExpectRead("scannet", Options(), 1000.0));
}

TEST_F(NumberedLayoutsTest, KnowsNotWhereScanNetsCamerasAre) {
  Write("color/0.jpg", ColorImage(0));
  Write("depth/0.png", DepthImage(0));
  WriteText("intrinsic/intrinsic_color.txt", kMatrix);
  WriteText("intrinsic/extrinsic_depth.txt",
            "1 0 0 0.04\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  ExpectInputError([this] { OpenSource("scannet", Options()); },
                   {"extrinsic_depth.txt:1: must be the identity"});
  OpenSource("scannet", WithCamera());
}

TEST_F(NumberedLayoutsTest, RegistersScanNetsSmallerDepth) {
  const cv::Size twice(2 * kWidth, 2 * kHeight);
  cv::Mat color;
  cv::resize(ColorImage(0), color, twice);
  Write("color/0.jpg", color);
  Write("depth/0.png", DepthImage(0));
  WriteText("intrinsic/intrinsic_color.txt",
            "60 0 31.5 0\n0 60 23.5 0\n0 0 1 0\n0 0 0 1\n");
  WriteText("intrinsic/intrinsic_depth.txt", kMatrix);
  const Frame frame = OpenSource("auto", Options())->Next()->read();
  EXPECT_EQ(frame.depth.size(), twice);
  EXPECT_EQ(cv::countNonZero(frame.depth == 1000), 4 * (kWidth * kHeight - 2));
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 3), 0) << "kNoDepth is none";
}

TEST_F(NumberedLayoutsTest, ReadsReplica) {
  std::string poses;
  for (int k = 0; k < kFrames; ++k) {
    Write("room0/results/frame" + Padded(k) + ".jpg", ColorImage(k));
    Write("room0/results/depth" + Padded(k) + ".png", DepthImage(k));
    poses += PoseText(k, " ") + "\n";
  }
  WriteText("room0/traj.txt", poses);
  WriteText("cam_params.json",
            R"({"camera": {"w": 32, "h": 24, "fx": 30.0, "fy": 30.0,
                           "cx": 15.5, "cy": 11.5, "scale": 6553.5}})");
  SourceOptions options = Options();
  options.path = folder_ / "room0";
  ExpectPoses(*ExpectRead("replica", options, 6553.5));

  // Poses belong to images by number, not by place among those that are left.
  fs::remove(folder_ / ("room0/results/depth" + Padded(0) + ".png"));
  Trajectory truth = OpenSource("auto", options)->ground_truth();
  ASSERT_EQ(truth.size(), kFrames - 1u);
  ExpectPose(truth[0].world_from_cam, 1);
  for (int k = 0; k + 1 < kFrames; ++k) {
    fs::remove(folder_ / ("room0/results/frame" + Padded(k) + ".jpg"));
  }
  truth = OpenSource("auto", options)->ground_truth();
  ASSERT_EQ(truth.size(), 1u);
  ExpectPose(truth[0].world_from_cam, kFrames - 1);
}

TEST_F(NumberedLayoutsTest, ReadsSemanticNerf) {
  std::string poses;
  for (int k = 0; k < kFrames; ++k) {
    Write("rgb/rgb_" + std::to_string(k) + ".png", ColorImage(k));
    Write("depth/depth_" + std::to_string(k) + ".png", DepthImage(k));
    poses += PoseText(k, " ") + "\n";
  }
  WriteText("traj_w_c.txt", poses);
  ExpectPoses(*ExpectRead("semantic_nerf", WithCamera(), 1000.0));
}

TEST_F(NumberedLayoutsTest, ReadsNamesInCapitalsAndJpeg) {
  for (int k = 0; k < kFrames; ++k) {
    Write("color/" + Padded(k) + ".jpg", ColorImage(k));
    Write("depth/" + Padded(k) + ".png", DepthImage(k));
    fs::rename(folder_ / ("color/" + Padded(k) + ".jpg"),
               folder_ / ("color/" + Padded(k) + (k > 0 ? ".JPG" : ".jpeg")));
    fs::rename(folder_ / ("depth/" + Padded(k) + ".png"),
               folder_ / ("depth/" + Padded(k) + ".PNG"));
  }
  ExpectRead("open3d", WithCamera(), 1000.0);
}

TEST_F(NumberedLayoutsTest, ReadsOpen3d) {
  std::string poses;
  for (int k = 0; k < kFrames; ++k) {
    Write("color/" + Padded(k) + ".jpg", ColorImage(k));
    Write("depth/" + Padded(k) + ".png", DepthImage(k));
    poses += "0 0 " + std::to_string(k) + "\n" + PoseText(k, "\n");
  }
  WriteText("trajectory.log", poses);
  WriteText("intrinsic.json",
            R"({"width": 32, "height": 24, "depth_scale": 4000.0,
                "intrinsic_matrix": [30, 0, 0, 0, 31, 0, 15.5, 11.5, 1]})");
  const auto source = ExpectRead("open3d", Options(), 4000.0);
  EXPECT_EQ(source->camera().camera.fy, 31.0);
  EXPECT_EQ(source->camera().camera.cx, 15.5);
  ExpectPoses(*source);
  // The file name used by Open3D's recorder.
  std::filesystem::rename(Options().path + "/intrinsic.json",
                          Options().path + "/camera_intrinsic.json");
  EXPECT_EQ(OpenSource("auto", Options())->camera().camera.fy, 31.0);
  // That of its samples.
  std::filesystem::rename(Options().path + "/camera_intrinsic.json",
                          Options().path + "/camera_primesense.json");
  EXPECT_EQ(OpenSource("auto", Options())->camera().camera.fy, 31.0);
  // Files that contain no valid camera.
  for (const auto& [wrong, problem] :
       {std::pair("-30, 0, 0, 0, 31, 0, 15.5, 11.5, 1]}",
                  "fx and fy must be positive"),
        {"30, 0, 0, 0, 31, 0, 15.5, 11.5, 1], \"depth_scale\": 0}",
         "depth_scale must be raw depth units per metre"}}) {
    WriteText("camera_intrinsic.json",
              std::string(R"({"width": 32, "height": 24,
                              "intrinsic_matrix": [)") +
                  wrong);
    ExpectInputError([&] { OpenSource("auto", Options()); },
                     {"camera_intrinsic.json", problem});
  }
}

TEST_F(NumberedLayoutsTest, ReadsImagesBesideEachOther) {
  for (int k = 0; k < kFrames; ++k) {
    const std::string number = "0000" + std::to_string(k);
    Write("frame_" + number + "_rgb.png", ColorImage(k));
    Write("frame_" + number + "_depth.png", DepthImage(k));
  }
  ExpectInputError([this] { OpenSource("auto", Options()); },
                   {folder_.path(), "contains no camera calibration",
                    "--camera", "presets tum_fr1, tum_fr2"});
  WriteText("camera-intrinsics.txt", "30 0 15.5\n0 31 11.5\n0 0 1\n");
  const auto source = ExpectRead("frame_pairs", Options(), 1000.0);
  EXPECT_EQ(source->camera().camera.fy, 31.0);
  EXPECT_EQ(source->camera().camera.width, kWidth);
}

// As RGB-D Scenes v2 names them.
TEST_F(NumberedLayoutsTest, ReadsNumbersBeforeTheKindOfImage) {
  for (int k = 0; k < kFrames; ++k) {
    const std::string number = "0000" + std::to_string(k);
    Write(number + "-color.png", ColorImage(k));
    Write(number + "-depth.png", DepthImage(k));
  }
  WriteText("camera-intrinsics.txt", "30 0 15.5\n0 31 11.5\n0 0 1\n");
  ExpectRead("frame_pairs", Options(), 1000.0);
}

}  // namespace
}  // namespace rgbd_pose
