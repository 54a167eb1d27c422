// rgbd_simulate and rgbd_slam from end to end: files in, files out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

const std::string kSlam = RGBD_SLAM;
constexpr size_t kSlamFrames = 40;

class SlamProgramTest : public ProgramTest {
 protected:
  SlamProgramTest() {
    Render("sequence",
           "--path=handheld --frames=" + std::to_string(kSlamFrames));
  }

  std::string Sequence() const { return folder_ / "sequence"; }

  RunResult Map(const std::string& output, const std::string& flags) const {
    return Run(kSlam + " --dataset=" + Sequence() + " --camera=" + Sequence() +
               "/camera.yaml --noreport --output=" + (folder_ / output) + " " +
               flags);
  }
};

// The angle (rad) between up in the first camera of two paths, z being up.
double TiltBetween(const Trajectory& a, const Trajectory& b) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return std::acos(
      std::min(1.0, (a[0].world_from_cam.rotation.conjugate() * z)
                        .dot(b[0].world_from_cam.rotation.conjugate() * z)));
}

TEST_F(SlamProgramTest, TheWorldIsUprightInAllFilesOnceGravityIsKnown) {
  Render("shaken", "--path=pan_tilt --frames=70 --imu");
  const auto run = [&](const std::string& output, const std::string& flags) {
    const RunResult result =
        Run(kSlam + " --dataset=" + (folder_ / "shaken") +
            " --noreport --output=" + (folder_ / output) + " " + flags);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const auto path = [&](const std::string& file) {
    return ReadTrajectory(folder_ / file);
  };
  const std::string map = folder_ / "upright_map";
  EXPECT_THAT(run("upright", "--upright --save_map=" + map),
              HasSubstr("up is (0.0000 0.0000 1.0000) in the world"));
  const Trajectory truth = path("shaken/groundtruth.txt");
  for (const char* file : {"trajectory.txt", "trajectory_online.txt"}) {
    EXPECT_LT(TiltBetween(path(std::string("upright/") + file), truth), 0.005)
        << file;
  }
  const auto metrics = nlohmann::json::parse(Read("upright/metrics.json"));
  EXPECT_LT(metrics.at("evaluation").at("ate").at("position_m").at("rmse"),
            0.005);

  // The same path, but for the turn.
  run("first_camera", "");
  const Trajectory turned = path("upright/trajectory.txt"),
                   other = path("first_camera/trajectory.txt");
  EXPECT_GT(TiltBetween(other, truth), 0.5);
  const Rigid3d moved =
      other[60].world_from_cam.Inverse() * other[0].world_from_cam *
      turned[0].world_from_cam.Inverse() * turned[60].world_from_cam;
  EXPECT_LT(moved.translation.norm() + moved.Angle(), 1e-6);

  // A map stays as it is.
  run("again", "--localise_only --load_map=" + map);
  EXPECT_LT(TiltBetween(path("again/trajectory.txt"), truth), 0.005);
}

TEST_F(SlamProgramTest, LeavesItsFilesAndKeepsAMapToTrackIn) {
  const std::string map = folder_ / "map";
  const RunResult first = Map("first", "--save_map=" + map);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("keyframes"));
  for (const char* file :
       {"trajectory.txt", "trajectory_online.txt", "trajectory_odometry.txt"}) {
    EXPECT_EQ(ReadTrajectory(folder_ / ("first/" + std::string(file))).size(),
              kSlamFrames)
        << file;
  }
  EXPECT_THAT(Read("first/graph.g2o"), HasSubstr("VERTEX_SE3:QUAT 0 0 0 0"));
  EXPECT_THAT(Read("first/keyframes.csv"), HasSubstr("cov_wx_wx"));
  EXPECT_THAT(Read("first/slam.csv"), HasSubstr("odom_tx"));
  const auto metrics = nlohmann::json::parse(Read("first/metrics.json"));
  EXPECT_EQ(metrics.at("program"), "rgbd_slam");
  EXPECT_GE(metrics.at("slam").at("keyframes"), 1);
  EXPECT_EQ(metrics.at("slam").at("keyframes_dropped"), 0);

  const std::string before = ReadTextFile(map + "/map.txt");
  const RunResult again = Map("again", "--localise_only --load_map=" + map);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(ReadTextFile(map + "/map.txt"), before);
  EXPECT_THAT(again.out, HasSubstr("1 segments joined"));
  // Poses from before the localisation in the map are in another world.
  const int from = nlohmann::json::parse(Read("again/metrics.json"))
                       .at("slam")
                       .at("localised_from_frame");
  EXPECT_THAT(again.out,
              HasSubstr("from frame " + std::to_string(from) + " on"));
  EXPECT_GT(from, 0);
  EXPECT_EQ(ReadTrajectory(folder_ / "again/trajectory_online.txt").size(),
            kSlamFrames - from);

  // Nor does a run that fails swell a map with segments of single frames.
  const RunResult lost = Map("lost",
                             "--tracker=features --min_inliers=5000 "
                             "--min_inliers_ok=5000 --load_map=" +
                                 map + " --save_map=" + map);
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_THAT(lost.out, HasSubstr("not saved: most frames were lost"));
  EXPECT_EQ(ReadTextFile(map + "/map.txt"), before);
}

}  // namespace
}  // namespace rgbd_pose
