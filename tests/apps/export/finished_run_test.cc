#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "apps/export/export_format.h"
#include "apps/export/run_states.h"
#include "apps/results/frame_tables.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// The noise (m) at a depth of 4 m in a cloud of a run with these settings, of a
// recording by a TUM RGB-D camera.
double NoiseOfCloudAt4M(const std::string& settings) {
  const TempFolder folder;
  const std::string recording = folder / "recording";
  for (const char* kind : {"rgb", "depth"}) {
    folder.Write(std::string("recording/") + kind + ".txt",
                 std::string("1.0 ") + kind + "/0.png\n");
    folder.Write(std::string("recording/") + kind + "/0.png", "");
  }
  folder.Write("run/frames.csv", "status,segment\nok,0\n");
  folder.Write("run/trajectory.txt", "1.0 0 0 0 0 0 0 1\n");
  folder.Write("run/config.flags", "# Input\n--dataset=" + recording +
                                       "\n--camera=tum_fr1\n" + settings);
  const FinishedRun run(folder / "run");
  return FusionOf<FusionOptions>(OpenRecording(run)->camera(), run, {})
      .depth.noise.sigma(4.0);
}

TEST(FinishedRunTest, ACloudHasTheDepthNoiseThatTrackingHad) {
  constexpr double kinect = 0.0008 + 0.0029 * 16.0;
  EXPECT_DOUBLE_EQ(NoiseOfCloudAt4M(""), kinect);
  EXPECT_DOUBLE_EQ(NoiseOfCloudAt4M("--depth_noise=camera\n"), kinect);
  EXPECT_DOUBLE_EQ(NoiseOfCloudAt4M("--depth_noise=constant\n"), 0.005);
}

// A depth scale of 5 made a cloud without points.
TEST(FinishedRunTest, SettingsThatAreNoneAreRefused) {
  ExpectInputError([] { NoiseOfCloudAt4M("--depth_scale=5OOO\n"); },
                   {"config.flags: '5OOO' is not a number for --depth_scale"});
  ExpectInputError([] { NoiseOfCloudAt4M("--max_features=99999999999\n"); },
                   {"'99999999999' is not a number for --max_features"});
  ExpectInputError([] { NoiseOfCloudAt4M("--depth_noise=constnt\n"); },
                   {"config.flags: unknown depth noise 'constnt'"});
  NoiseOfCloudAt4M("--max_sigma_ok=inf\n--max_features=300\n");
}

// A camera that was found in one of two maps: its first frames were in a world
// of their own, the second map is in another one.
TEST(FinishedRunTest, FramesAreInTheSegmentThatTheirsHasJoined) {
  const TempFolder folder;
  folder.Write("run/frames.csv", "status,segment\nok,2\nlost,3\nok,0\n");
  folder.Write("run/slam.csv", "final_segment\n0\n-1\n0\n");
  folder.Write("run/keyframes.csv", "timestamp,segment\n1.0,0\n1.0,1\n");
  folder.Write("run/trajectory.txt", "1 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n");
  folder.Write("run/config.flags", "# Input\n--dataset=none\n");
  folder.Write("run/metrics.json",
               R"({"gravity": {"up": [0, 0, 1], "segment": 0}})");
  const FinishedRun run(folder / "run");
  EXPECT_EQ(run.segments, std::vector<int>(2, 0));
  EXPECT_FALSE(run.level_from_world.IsIdentity());
  folder.Write("run/slam.csv", "final_segment\n0\n");
  ExpectInputError([&] { FinishedRun(folder / "run"); },
                   {"slam.csv: has 1 frames, but frames.csv 3; repeat"});
}

// The same recording was mapped before: the keyframes of both runs have the
// same times. The one of the first frame was removed, as it was redundant.
TEST(FinishedRunTest, KeyframesOfALoadedMapDoNotSayHowExactItsPosesAre) {
  const TempFolder folder;
  folder.Write("run/frames.csv", "status,segment\nok,0\nok,0\n");
  folder.Write("run/edges.csv", FormatEdgesCsv({}));
  std::string keyframes =
      std::string("keyframe,timestamp,segment") + kCovarianceColumns + "\n";
  for (const auto& [start, variance] :
       {std::pair("0,1,0", ",4"), std::pair("1,2,0", ",4"),
        std::pair("4,2,0", ",9")}) {
    keyframes += start;
    for (int i = 0; i < 21; ++i) keyframes += variance;
    keyframes += "\n";
  }
  folder.Write("run/keyframes.csv", keyframes);
  folder.Write("run/trajectory.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  folder.Write("run/config.flags", "# Input\n--dataset=none\n");
  const FinishedRun run(folder / "run");
  const std::vector<CameraState> states = StatesOf(run, run.trajectory);
  EXPECT_EQ(states[0].covariance, MotionMatrix::Zero()) << "not known";
  EXPECT_EQ(states[1].covariance, MotionMatrix::Constant(9));
}

// Down and ahead of a level camera, in the world of a run with these metrics.
std::pair<Eigen::Vector3d, Eigen::Vector3d> LevelIn(
    const std::string& metrics) {
  const TempFolder folder;
  folder.Write("run/frames.csv", "status,segment\nok,2\n");
  folder.Write("run/trajectory.txt", "1.0 0 0 0 0 0 0 1\n");
  folder.Write("run/config.flags", "# Input\n--dataset=none\n");
  if (!metrics.empty()) folder.Write("run/metrics.json", metrics);
  const FinishedRun run(folder / "run");
  const Rigid3d world_from_level = run.level_from_world.Inverse();
  return {world_from_level * Eigen::Vector3d::UnitY(),
          world_from_level * Eigen::Vector3d::UnitZ()};
}

TEST(FinishedRunTest, IsLevelByGravityOrElseByItsFirstCamera) {
  const auto expect = [](const std::string& metrics,
                         const Eigen::Vector3d& down,
                         const Eigen::Vector3d& ahead) {
    const auto [is_down, is_ahead] = LevelIn(metrics);
    EXPECT_TRUE(is_down.isApprox(down, 1e-12)) << is_down.transpose();
    EXPECT_TRUE(is_ahead.isApprox(ahead, 1e-12)) << is_ahead.transpose();
  };
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  for (const char* metrics :
       {"", "{}", R"({"gravity": {"refusal": "no samples", "means": 0}})",
        R"({"gravity": {"up": [0, 0, 1], "segment": 1}})", "{"}) {
    expect(metrics, y, z);
  }
  // An upright world.
  expect(R"({"gravity": {"up": [0, 0, 1], "segment": 2}})", -z, y);
  // A first camera that looks down by asin(0.6).
  expect(R"({"gravity": {"up": [0, -0.8, -0.6], "segment": 2}})", {0, 0.8, 0.6},
         {0, -0.6, 0.8});
}

TEST(FinishedRunTest, SaysThatUpMustBeThreeNumbers) {
  for (const char* up : {R"("above")", "[0, 1]", R"([0, "a", 1])", "null"}) {
    ExpectInputError(
        [&] {
          LevelIn(std::string(R"({"gravity": {"segment": 2, "up": )") + up +
                  "}}");
        },
        {"metrics.json", "up of gravity must be three numbers"});
  }
}

TEST(PoseExportsTest, TellOfPosesInOtherWorlds) {
  const TempFolder folder;
  folder.Write("run/frames.csv", "status,segment\nok,0\nok,1\nok,1\n");
  folder.Write("run/trajectory.txt",
               "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n");
  folder.Write("run/config.flags", "# Input\n--dataset=none\n");
  FinishedRun run(folder / "run");
  ExportOptions options;
  for (const auto write : {ExportTum, ExportKitti}) {
    options.output = folder / (write == ExportTum ? "tum.txt" : "kitti");
    const std::string text = "3 poses in " + options.output + "\n";
    run.segments = {0, 1, 1};
    EXPECT_EQ(write(run, options),
              text +
                  "2 of the poses are of other segments: their position "
                  "relative to the first segment is unknown\n");
    run.segments = {0, 0, 0};
    options.overwrite = true;
    EXPECT_EQ(write(run, options), text);
  }
}

// 65535 would be read as a depth of 65.5 m, or as none.
TEST(DepthInMillimetresTest, WhatDoesNotFitIsMissing) {
  Frame frame;
  frame.depth_scale = 500.0;
  frame.depth = (cv::Mat_<uint16_t>(1, 5) << 0, 1000, 32767, 32768, 65535);
  const cv::Mat expected = (cv::Mat_<uint16_t>(1, 5) << 0, 2000, 65534, 0, 0);
  EXPECT_EQ(cv::norm(DepthInMillimetres(frame), expected, cv::NORM_INF), 0.0);
  frame.depth_scale = 5000.0;
  EXPECT_EQ(DepthInMillimetres(frame).at<uint16_t>(3), 6554);
}

}  // namespace
}  // namespace rgbd_pose
