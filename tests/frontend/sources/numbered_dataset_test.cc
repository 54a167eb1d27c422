#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "frontend/sources/open_source.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 3;

// Half a turn around y, and a step to the right for each frame.
std::string PoseText(int k, const char* end_of_row) {
  const std::string end = end_of_row;
  return "-1 0 0 " + std::to_string(k) + end + "0 1 0 0.5" + end + "0 0 -1 2" +
         end + "0 0 0 1" + end;
}

void ExpectPose(const Rigid3d& pose, int k) {
  EXPECT_NEAR(pose.Angle(), M_PI, 1e-9);
  EXPECT_LT((pose.translation - Eigen::Vector3d(k, 0.5, 2.0)).norm(), 1e-12);
  EXPECT_LT((pose * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(k - 1, 2.5, -1))
                .norm(),
            1e-9);
}

// The intrinsics of SmallCamera() in a file of ScanNet.
constexpr char kMatrix[] = "30 0 15.5 0\n0 30 11.5 0\n0 0 1 0\n0 0 0 1\n";

std::string Padded(int k) {
  const std::string digits = std::to_string(k);
  return std::string(6 - digits.size(), '0') + digits;
}

class NumberedDatasetTest : public testing::Test {
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

TEST_F(NumberedDatasetTest, ReadsSevenScenes) {
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

TEST_F(NumberedDatasetTest, ReadsBundleFusion) {
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

TEST_F(NumberedDatasetTest, ReadsDepthAs3RScanHasIt) {
  Write("frame-000000.color.jpg", ColorImage(0));
  std::string pgm = "P5\n32 24\n65535\n";  // with the high byte first
  for (int i = 0; i < kWidth * kHeight; ++i) pgm += "\x03\xE8";  // 1000
  WriteText("frame-000000.depth.pgm", pgm);
  const Frame frame = OpenSource("bundlefusion", WithCamera())->Next()->read();
  EXPECT_EQ(frame.depth.at<uint16_t>(5, 5), 1000);
}

TEST_F(NumberedDatasetTest, ReadsScanNet) {
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
TEST_F(NumberedDatasetTest, ReadsPosesOfScanNetWithLeadingZeros) {
  for (int k = 0; k < kFrames; ++k) {
    Write("color/" + Padded(k) + ".jpg", ColorImage(k));
    Write("depth/" + Padded(k) + ".png", DepthImage(k));
    WriteText("pose/" + Padded(k) + ".txt", PoseText(k, "\n"));
  }
  WriteText("intrinsic/intrinsic_color.txt", kMatrix);
  ExpectPoses(*ExpectRead("scannet", Options(), 1000.0));
}

TEST_F(NumberedDatasetTest, KnowsNotWhereScanNetsCamerasAre) {
  Write("color/0.jpg", ColorImage(0));
  Write("depth/0.png", DepthImage(0));
  WriteText("intrinsic/intrinsic_color.txt", kMatrix);
  WriteText("intrinsic/extrinsic_depth.txt",
            "1 0 0 0.04\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  ExpectInputError([this] { OpenSource("scannet", Options()); },
                   {"extrinsic_depth.txt:1: must be the identity"});
  OpenSource("scannet", WithCamera());
}

TEST_F(NumberedDatasetTest, RegistersScanNetsSmallerDepth) {
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

TEST_F(NumberedDatasetTest, ReadsReplica) {
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

TEST_F(NumberedDatasetTest, ReadsSemanticNerf) {
  std::string poses;
  for (int k = 0; k < kFrames; ++k) {
    Write("rgb/rgb_" + std::to_string(k) + ".png", ColorImage(k));
    Write("depth/depth_" + std::to_string(k) + ".png", DepthImage(k));
    poses += PoseText(k, " ") + "\n";
  }
  WriteText("traj_w_c.txt", poses);
  ExpectPoses(*ExpectRead("semantic_nerf", WithCamera(), 1000.0));
}

TEST_F(NumberedDatasetTest, ReadsNamesInCapitalsAndJpeg) {
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

TEST_F(NumberedDatasetTest, ReadsOpen3d) {
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

TEST_F(NumberedDatasetTest, ReadsImagesBesideEachOther) {
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

TEST_F(NumberedDatasetTest, MentionsMasksThatFitNoImage) {
  WriteSevenScenes();
  WriteText("mask/0.png", "");
  EXPECT_NE(OpenSource("auto", WithCamera())
                ->remarks()
                .back()
                .find("has no mask of a colour image"),
            std::string::npos);
}

TEST_F(NumberedDatasetTest, TakesTimesWhereTheyLie) {
  WriteSevenScenes();
  EXPECT_NE(OpenSource("auto", WithCamera())
                ->remarks()
                .front()
                .find("30 frames per second are assumed"),
            std::string::npos);
  fs::remove(folder_ / ("frame-" + Padded(0) + ".depth.png"));
  WriteText("timestamps.txt", "0 10.0\n1 10.05\n2 10.1\n");
  const auto source = OpenSource("auto", WithCamera());
  EXPECT_EQ(source->timestamps(), (std::vector<double>{10.05, 10.1}));
  EXPECT_EQ(source->ground_truth().front().timestamp, 10.05);
  EXPECT_TRUE(source->remarks().empty());
  WriteText("timestamps.txt", "10.0\n10.05\n");
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {"timestamps.txt: has 2 times, but there are 3 colour"});
  WriteText("timestamps.txt", "10.0\n10.05\n10.05\n");
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {"timestamps.txt:3: the time is not after"});
}

// All recordings of 7-Scenes are of a Kinect, whose rows are read one by one.
TEST_F(NumberedDatasetTest, KnowsTheShutterOfSevenScenes) {
  WriteSevenScenes();
  EXPECT_EQ(OpenSource("auto", WithCamera())->camera().color_shutter.readout,
            0.028);
  SourceOptions options = WithCamera();
  options.camera->color_shutter.is_known = true;  // none, as its file says
  EXPECT_EQ(OpenSource("auto", options)->camera().color_shutter.readout, 0.0);
}

// Their camera is used with a remark, unless the recording has one.
TEST_F(NumberedDatasetTest, SaysThatItTakesTheCameraOfSevenScenes) {
  WriteSevenScenes();
  fs::create_directory(folder_ / "seq-01");
  for (const fs::directory_entry& entry :
       fs::directory_iterator(folder_.path())) {
    if (!entry.is_regular_file()) continue;
    fs::rename(entry.path(),
               folder_ / ("seq-01/" + entry.path().filename().string()));
  }
  SourceOptions options = Options();
  options.path = folder_ / "seq-01";
  const auto source = OpenSource("auto", options);
  EXPECT_EQ(source->camera().camera.fx, 585.0);
  EXPECT_NE(source->remarks().back().find("that of the preset 7scenes"),
            std::string::npos);
  // As 3DMatch has it for all recordings of a scene.
  WriteText("camera-intrinsics.txt", kMatrix);
  const auto own = OpenSource("auto", options);
  EXPECT_EQ(own->camera().camera.fx, 30.0);
  EXPECT_EQ(own->remarks().size(), 1u) << "only the times";
}

TEST_F(NumberedDatasetTest, LeavesOutWhatHasNoPartner) {
  WriteSevenScenes();
  fs::remove(folder_ / ("frame-" + Padded(1) + ".depth.png"));
  const auto source = OpenSource("auto", WithCamera());
  EXPECT_EQ(source->timestamps(), (std::vector<double>{0.0, 2.0 / 30.0}));
  EXPECT_EQ(source->unmatched_color(), 1);
  EXPECT_EQ(source->ground_truth().size(), 2u);
}

TEST_F(NumberedDatasetTest, SaysWhichDepthImagesAreMissing) {
  Write("color/000000.png", ColorImage(0));
  Write("depth/000000.jpg", ColorImage(0));  // for display
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {folder_.path(), "none of its 1 colour images",
                    "a depth image depth/123.png of the same number"});
}

TEST_F(NumberedDatasetTest, SaysWhatDepthOfAnotherSizeNeeds) {
  Write("color/000000.png", ColorImage(0));
  Write("depth/000000.png", cv::Mat(kHeight / 2, kWidth / 2, CV_16UC1));
  const auto source = OpenSource("auto", WithCamera());
  ExpectInputError([&] { source->Next()->read(); },
                   {"000000.png: is 16 x 12 pixels, the camera has 32 x 24; if "
                    "another camera took depth, give both"});
}

TEST_F(NumberedDatasetTest, TakesADepthScaleThatIsAskedFor) {
  WriteSevenScenes();
  SourceOptions options = WithCamera();
  options.depth_scale = 5000.0;
  EXPECT_EQ(OpenSource("auto", options)->camera().depth_scale, 5000.0);
  options.depth_scale = 0.0;
  options.camera->depth_scale = 2000.0;
  EXPECT_EQ(OpenSource("auto", options)->camera().depth_scale, 2000.0);
}

TEST_F(NumberedDatasetTest, RefusesWhatCannotBeUsed) {
  WriteSevenScenes();
  ExpectInputError([this] { OpenSource("scannet", WithCamera()); },
                   {folder_.path(), "no colour images", "color/123.jpg"});
  const auto expect_bad_pose = [this](const std::string& text,
                                      const std::string& problem) {
    WriteText("frame-000001.pose.txt", text);
    const auto source = OpenSource("auto", WithCamera());
    ExpectInputError([&] { source->ground_truth(); },
                     {"frame-000001.pose.txt", problem});
  };
  expect_bad_pose("1 0 0 0\n0 1 0 0\n", "needs 4 rows");
  expect_bad_pose("1 0 0 0\n0 1 0 0\n0 0 1 x\n0 0 0 1", ":3");
  expect_bad_pose("1 0 0 0\n0 2 0 0\n0 0 1 0\n0 0 0 1", "not a rotation");
  expect_bad_pose(PoseText(0, "\n") + "1", "more than");
  for (int k = 0; k < kFrames; ++k) {
    fs::rename(folder_ / ("frame-" + Padded(k) + ".depth.png"),
               folder_ / ("frame-" + Padded(k + 10) + ".depth.png"));
  }
  ExpectInputError([this] { OpenSource("auto", WithCamera()); },
                   {folder_.path(), "none of its 3 colour images"});
  // A truncated image.
  WriteText("frame-000010.color.png", "");
  const auto source = OpenSource("auto", WithCamera());
  ExpectInputError([&] { source->Next()->read(); }, {"frame-000010.color.png"});
}

}  // namespace
}  // namespace rgbd_pose
