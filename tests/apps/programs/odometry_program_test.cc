// rgbd_simulate and rgbd_odometry from end to end: files in, files out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kTracker = RGBD_ODOMETRY;
constexpr int kShortRun = 6;

class OdometryProgramTest : public ProgramTest {
 protected:
  OdometryProgramTest() {
    Render("sequence", "--path=xyz --frames=" + std::to_string(kShortRun));
  }

  std::string Sequence() const { return folder_ / "sequence"; }

  std::string Call(const std::string& output) const {
    return kTracker + " --dataset=" + Sequence() + " --camera=" + Sequence() +
           "/camera.yaml --output=" + (folder_ / output);
  }
};

// frames.csv without the columns of times, which differ from run to run.
std::string WithoutTimes(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line, result;
  while (std::getline(lines, line)) {
    for (int i = 0; i < 6; ++i) line.erase(line.rfind(','));
    result += line + "\n";
  }
  return result;
}

TEST_F(OdometryProgramTest, SaysWhichDebugImagesThereCannotBe) {
  const RunResult run = Run(Call("run") + " --noreport --debug_images=2,500");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("--debug_images: there is no frame 500; the "
                                 "6 frames are numbered from 0\n"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/debug/000002.png"));
}

// The world is the first camera of a path whose z axis is up.
TEST_F(OdometryProgramTest, FindsGravityWhereThereAreInertialSamples) {
  ASSERT_EQ(Run(Call("without") + " --noreport").exit_code, 0);
  const auto metrics = [&](const std::string& run) {
    return nlohmann::json::parse(Read((run + "/metrics.json")));
  };
  EXPECT_EQ(metrics("without").count("gravity"), 0);
  Render("shaken", "--path=pan_tilt --frames=70 --imu");
  const std::string track = kTracker + " --dataset=" + (folder_ / "shaken") +
                            " --noreport --output=" + (folder_ / "run");
  const RunResult short_run = Run(track + " --frames=0-20");
  EXPECT_THAT(short_run.out, HasSubstr("gravity     not determined: 0 parts"));
  const RunResult run = Run(track);
  EXPECT_THAT(run.out, HasSubstr("gravity     up is ("));
  const nlohmann::json gravity = metrics("run").at("gravity");
  const Trajectory truth = ReadTrajectory(folder_ / "shaken/groundtruth.txt");
  const Eigen::Vector3d up =
      truth[0].world_from_cam.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(gravity.at("up")[axis].get<double>(), up[axis], 0.005);
  }
  EXPECT_EQ(short_run.err.find("mounting"), std::string::npos);
  std::filesystem::remove(folder_ / "shaken/imu.yaml");
  EXPECT_THAT(Run(track + " --frames=0-20").err,
              HasSubstr("the mounting of the inertial sensor"));
}

TEST_F(OdometryProgramTest, WritesARowPerFrameAndAllFiles) {
  const RunResult run = Run(Call("run"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("100.0 % tracked"));
  EXPECT_THAT(run.out, HasSubstr("frames/s with decoding"));
  // At most ten lines of errors, the last of which says where all are.
  const size_t errors = run.out.find("errors of 6 poses");
  const size_t end =
      run.out.find("all errors  in " + (folder_ / "run/metrics.json\n"));
  ASSERT_LT(errors, end);
  ASSERT_NE(end, std::string::npos);
  EXPECT_LE(std::count(run.out.begin() + errors, run.out.begin() + end, '\n'),
            9);
  const std::string csv = Read("run/frames.csv");
  EXPECT_EQ(
      csv.substr(0, csv.find('\n')),
      "timestamp,status,reason,segment,reference,is_reference,"
      "relocalised,predicted,tracking_source,matches,inliers,iterations,sigma,"
      "tx,ty,tz,qx,qy,qz,qw,"
      "decode_ms,track_ms,match_ms,solve_ms,reference_ms,relocalise_ms");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + kShortRun);
  const std::string edges = Read("run/edges.csv");
  EXPECT_GE(std::count(edges.begin(), edges.end(), '\n'), kShortRun);
  EXPECT_EQ(ReadTrajectory(folder_ / "run/trajectory.txt").size(),
            static_cast<size_t>(kShortRun));
  const auto metrics = nlohmann::json::parse(Read("run/metrics.json"));
  EXPECT_EQ(metrics.at("run").at("frames"), kShortRun);
  EXPECT_GT(metrics.at("run").at("decode_ms_median"), 0.0);
  const double seconds = metrics.at("run").at("wall_seconds");
  EXPECT_GT(seconds, 0.0);
  // Both numbers are written with all their digits.
  EXPECT_NEAR(metrics.at("run").at("frames_per_second"), kShortRun / seconds,
              1e-6);
  // A frame with its pyramid takes 1.5 MB; leaking six hundred would be seen.
  EXPECT_GT(metrics.at("peak_rss_mb"), 1.0);
  EXPECT_LT(metrics.at("peak_rss_mb"), 500.0);
  EXPECT_LT(metrics.at("evaluation").at("ate").at("position_m").at("rmse"),
            0.005);
}

TEST_F(OdometryProgramTest, ARecordingAsTheFirstWordIsEnough) {
  const std::string run =
      "cd " + folder_.path() + " && " + kTracker + " sequence --noreport";
  for (const std::string output : {"runs/sequence", "runs/sequence-2"}) {
    ASSERT_EQ(Run(run).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / (output + "/metrics.json")));
    EXPECT_THAT(Read((output + "/config.flags")),
                HasSubstr("--output=" + output + "\n"));
  }
  EXPECT_THAT(Run(kTracker + " sequence more").err,
              HasSubstr("'more' is not a flag"));
}

// With relative paths too, where the run was started, as the report says.
TEST_F(OdometryProgramTest, RepeatsARunFromItsFlagFile) {
  const std::string in_folder = "cd " + folder_.path() + " && " + kTracker;
  ASSERT_EQ(Run(in_folder +
                " --noreport --dataset=sequence --camera=sequence/camera.yaml "
                "--output=runs/first --loss=huber --max_features=300")
                .exit_code,
            0);
  const std::string flags = " --flagfile=runs/first/config.flags";
  ASSERT_EQ(Run(in_folder + flags + " --output=runs/second").exit_code, 0);
  const auto read = [&](const std::string& file) {
    return Read(("runs/" + file));
  };
  const std::string path = read("first/trajectory.txt");
  EXPECT_EQ(read("second/trajectory.txt"), path);
  EXPECT_EQ(WithoutTimes(read("second/frames.csv")),
            WithoutTimes(read("first/frames.csv")));
  std::filesystem::remove(folder_ / "runs/first/trajectory.txt");
  ASSERT_EQ(Run(in_folder + flags).exit_code, 0);
  EXPECT_EQ(read("first/trajectory.txt"), path);
}

TEST_F(OdometryProgramTest, ThreadsDoNotChangeTheResult) {
  ASSERT_EQ(Run(Call("one") + " --threads=1").exit_code, 0);
  for (const std::string threads : {"0", "5"}) {
    ASSERT_EQ(Run(Call("many") + " --threads=" + threads).exit_code, 0);
    EXPECT_EQ(Read("one/trajectory.txt"), Read("many/trajectory.txt"));
    EXPECT_EQ(WithoutTimes(Read("one/frames.csv")),
              WithoutTimes(Read("many/frames.csv")));
  }
}

TEST_F(OdometryProgramTest, SavesACloudOfTheRoom) {
  const auto cloud = [this](const std::string& threads) {
    const std::string file = folder_ / ("cloud" + threads + ".ply");
    const RunResult run = Run(Call("run") + " --threads=" + threads +
                              " --voxel=0.02 --save_cloud=" + file);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr(file));
    return ReadTextFile(file);
  };
  const std::string bytes = cloud("1");
  EXPECT_EQ(bytes, cloud("2"));
  // A view into the furnished room shows some square metres, with 2500 voxels
  // of 15 bytes each. Making the cloud later gives the same one.
  EXPECT_GT(bytes.size(), 15u * 10000u);
  const std::string later = folder_ / "later.ply";
  const RunResult exported =
      Run(RGBD_EXPORT " --to=cloud --voxel=0.02 --run=" + (folder_ / "run") +
          " --output=" + later);
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_TRUE(ReadTextFile(later) == bytes) << "not the cloud of the run";
}

TEST_F(OdometryProgramTest, ValidatesWithoutTracking) {
  const std::string call = kTracker +
                           " --validate_only --dataset=" + Sequence() +
                           " --camera=" + Sequence() + "/camera.yaml";
  const RunResult good = Run(call);
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out,
              HasSubstr(std::to_string(kShortRun) + ", all readable"));
  EXPECT_THAT(good.out, HasSubstr("frames/s"));

  // The first of two damaged images is reported.
  const std::string images[] = {"depth/1000.066667.png", "rgb/1000.100000.png"};
  for (const std::string& image : images) {
    ASSERT_TRUE(std::filesystem::exists(Sequence() + "/" + image)) << image;
    std::filesystem::resize_file(Sequence() + "/" + image, 1000);
  }
  const RunResult bad = Run(call + " --threads=3 --max_damaged=0");
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_EQ(bad.out, "");
  EXPECT_THAT(bad.err, HasSubstr(images[0]));
  EXPECT_THAT(bad.err, Not(HasSubstr(images[1])));
}

}  // namespace
}  // namespace rgbd_pose
