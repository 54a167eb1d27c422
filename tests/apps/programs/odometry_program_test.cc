// rgbd_simulate and rgbd_odometry from end to end: files in, files out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kSimulator = RGBD_SIMULATE;
const std::string kTracker = RGBD_ODOMETRY;
constexpr int kShortRun = 6;

class OdometryProgramTest : public testing::Test {
 protected:
  OdometryProgramTest() {
    const RunResult run = RunCommand(
        kSimulator + " --path=xyz --frames=" + std::to_string(kShortRun) +
            " --output=" + Sequence(),
        folder_);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }

  std::string Sequence() const { return folder_ / "sequence"; }

  std::string Call(const std::string& output) const {
    return kTracker + " --dataset=" + Sequence() + " --camera=" + Sequence() +
           "/camera.yaml --output=" + (folder_ / output);
  }

  RunResult Run(const std::string& command) const {
    return RunCommand(command, folder_);
  }

  const TempFolder folder_;
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
    return nlohmann::json::parse(
        ReadTextFile(folder_ / (run + "/metrics.json")));
  };
  EXPECT_EQ(metrics("without").count("gravity"), 0);
  ASSERT_EQ(Run(kSimulator + " --path=pan_tilt --frames=70 --imu --output=" +
                (folder_ / "shaken"))
                .exit_code,
            0);
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
}

TEST_F(OdometryProgramTest, WritesARowPerFrameAndAllFiles) {
  const RunResult run = Run(Call("run"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("100.0 % tracked"));
  EXPECT_THAT(run.out, HasSubstr("frames/s with decoding"));
  // At most ten lines of errors, the last of which says where all are.
  const size_t errors = run.out.find("errors of 6 poses");
  const size_t end = run.out.find("all errors  in the report and in " +
                                  (folder_ / "run/metrics.json\n"));
  ASSERT_LT(errors, end);
  ASSERT_NE(end, std::string::npos);
  EXPECT_LE(std::count(run.out.begin() + errors, run.out.begin() + end, '\n'),
            9);
  const std::string csv = ReadTextFile(folder_ / "run/frames.csv");
  EXPECT_EQ(
      csv.substr(0, csv.find('\n')),
      "timestamp,status,reason,segment,reference,is_reference,"
      "relocalised,predicted,tracking_source,matches,inliers,iterations,sigma,"
      "tx,ty,tz,qx,qy,qz,qw,"
      "decode_ms,track_ms,match_ms,solve_ms,reference_ms,relocalise_ms");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + kShortRun);
  const std::string edges = ReadTextFile(folder_ / "run/edges.csv");
  EXPECT_GE(std::count(edges.begin(), edges.end(), '\n'), kShortRun);
  EXPECT_EQ(ReadTrajectory(folder_ / "run/trajectory.txt").size(),
            static_cast<size_t>(kShortRun));
  const auto metrics =
      nlohmann::json::parse(ReadTextFile(folder_ / "run/metrics.json"));
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
    EXPECT_THAT(ReadTextFile(folder_ / (output + "/config.flags")),
                HasSubstr("--output=" + output + "\n"));
  }
  EXPECT_THAT(Run(kTracker + " sequence more").err,
              HasSubstr("'more' is not a flag"));
}

// As the report says: where the run was started.
TEST_F(OdometryProgramTest, RepeatsARunWithRelativePaths) {
  const std::string in_folder = "cd " + folder_.path() + " && ";
  ASSERT_EQ(Run(in_folder + kTracker +
                " --noreport --dataset=sequence --camera=sequence/camera.yaml "
                "--output=runs/first")
                .exit_code,
            0);
  const std::string before =
      ReadTextFile(folder_ / "runs/first/trajectory.txt");
  std::filesystem::remove(folder_ / "runs/first/trajectory.txt");
  const RunResult again =
      Run(in_folder + kTracker + " --flagfile=runs/first/config.flags");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(ReadTextFile(folder_ / "runs/first/trajectory.txt"), before);
}

TEST_F(OdometryProgramTest, RepeatsARunFromItsFlagFile) {
  ASSERT_EQ(Run(Call("first") + " --loss=huber --max_features=300").exit_code,
            0);
  const std::string flags = folder_ / "first/config.flags";
  ASSERT_EQ(Run(kTracker + " --flagfile=" + flags +
                " --output=" + (folder_ / "second"))
                .exit_code,
            0);
  for (const std::string file : {"trajectory.txt", "frames.csv"}) {
    std::string first = ReadTextFile(folder_ / ("first/" + file));
    std::string second = ReadTextFile(folder_ / ("second/" + file));
    if (file == "frames.csv") {
      first = WithoutTimes(first);
      second = WithoutTimes(second);
    }
    EXPECT_EQ(first, second) << file;
  }
}

TEST_F(OdometryProgramTest, ThreadsDoNotChangeTheResult) {
  ASSERT_EQ(Run(Call("one") + " --threads=1").exit_code, 0);
  for (const std::string threads : {"0", "2", "5"}) {
    ASSERT_EQ(Run(Call("many") + " --threads=" + threads).exit_code, 0);
    EXPECT_EQ(ReadTextFile(folder_ / "one/trajectory.txt"),
              ReadTextFile(folder_ / "many/trajectory.txt"));
    EXPECT_EQ(WithoutTimes(ReadTextFile(folder_ / "one/frames.csv")),
              WithoutTimes(ReadTextFile(folder_ / "many/frames.csv")));
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

  const std::string kStart =
      "ply\nformat binary_little_endian 1.0\nelement vertex ";
  ASSERT_EQ(bytes.substr(0, kStart.size()), kStart);
  const size_t points = std::stoul(bytes.substr(kStart.size()));
  const std::string kHeaderEnd = "end_header\n";
  const size_t first = bytes.find(kHeaderEnd) + kHeaderEnd.size();
  constexpr size_t kPointBytes = 15;
  ASSERT_EQ(bytes.size(), first + kPointBytes * points);
  // A view into a furnished room of 5 x 4 x 2.6 m shows some square metres,
  // with 2500 voxels each, or a few times as many where noise spreads them.
  EXPECT_GT(points, 10000u);
  EXPECT_LT(points, 300000u);
  float nearest = 100.0F, furthest = 0.0F;
  for (size_t i = 0; i < points; ++i) {
    float z;
    std::memcpy(&z, &bytes[first + kPointBytes * i + 8], sizeof(z));
    nearest = std::min(nearest, z);
    furthest = std::max(furthest, z);
  }
  EXPECT_GT(nearest, 0.25F);  // the minimum range of sensors
  EXPECT_GT(furthest, 1.5F);
  EXPECT_LT(furthest, 6.4F);  // the room's diagonal
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
