// Runs the built programs and checks their exit codes and output streams.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr char kTruth[] =
    "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 1 1 0 0 0 0 1\n3 1 1 1 0 0 0 1\n";
// The same path in a world that is rotated by 90 degrees about z.
constexpr char kTurned[] =
    "0 0 0 0 0 0 .70710678 .70710678\n1 0 1 0 0 0 .70710678 .70710678\n"
    "2 -1 1 0 0 0 .70710678 .70710678\n3 -1 1 1 0 0 .70710678 .70710678\n";

class ProgramsTest : public testing::Test {
 protected:
  ProgramsTest() {
    folder_.Write("truth.txt", kTruth);
    folder_.Write("turned.txt", kTurned);
  }

  RunResult Evaluate(const std::string& flags) const {
    const RunResult run = RunCommand(
        std::string(RGBD_EVALUATE) + " --estimate=" + (folder_ / "turned.txt") +
            " --groundtruth=" + (folder_ / "truth.txt") + " " + flags,
        folder_);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    return run;
  }

  const TempFolder folder_;
};

TEST_F(ProgramsTest, HelpNamesTheFlagsOfTheProgramAlone) {
  for (const std::string help : {"--help", "-h", "--json --help"}) {
    const RunResult run = Evaluate(help);
    EXPECT_THAT(run.out, HasSubstr("Example:"));
    EXPECT_THAT(run.out, HasSubstr("Exit codes:"));
    for (const std::string flag :
         {"estimate", "groundtruth", "max_time_difference", "rpe_delta_seconds",
          "rpe_delta_metres", "json", "aligned"}) {
      EXPECT_THAT(run.out, HasSubstr("\n  --" + flag + " ("));
    }
    EXPECT_THAT(run.out, Not(HasSubstr("minloglevel")));  // of glog
    EXPECT_THAT(run.out, Not(HasSubstr("fromenv")));      // of gflags
  }
}

TEST_F(ProgramsTest, EvaluatePrintsJson) {
  const nlohmann::json json = nlohmann::json::parse(Evaluate("--json").out);
  EXPECT_EQ(json.at("paired_poses"), 4);
  EXPECT_EQ(json.at("rpe_seconds").at("count"), 3);
  // The file's quaternion has 8 digits.
  EXPECT_LT(json.at("ate").at("position_m").at("rmse"), 1e-7);
}

TEST_F(ProgramsTest, EvaluatePrintsATableAndWritesTheAlignedEstimate) {
  const RunResult run = Evaluate("--aligned=" + (folder_ / "aligned.txt"));
  EXPECT_THAT(run.out, HasSubstr("4 of 4 estimated poses"));
  EXPECT_THAT(run.out, HasSubstr("ATE, rigid alignment, no scale (4 poses)"));
  const Trajectory truth = ReadTrajectory(folder_ / "truth.txt");
  const Trajectory aligned = ReadTrajectory(folder_ / "aligned.txt");
  ASSERT_EQ(aligned.size(), truth.size());
  for (size_t i = 0; i < truth.size(); ++i) {
    const Rigid3d error =
        truth[i].world_from_cam.Inverse() * aligned[i].world_from_cam;
    EXPECT_EQ(aligned[i].timestamp, truth[i].timestamp);
    EXPECT_LT(error.translation.norm(), 1e-7);
    EXPECT_LT(error.Angle(), 1e-7);
  }
}

}  // namespace
}  // namespace rgbd_pose
