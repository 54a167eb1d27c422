// Runs the built programs and checks their exit codes and output streams.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kEvaluate = RGBD_EVALUATE;

constexpr char kTruth[] =
    "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 1 1 0 0 0 0 1\n3 1 1 1 0 0 0 1\n";
// The same path in a world that is rotated by 90 degrees about z.
constexpr char kTurned[] =
    "0 0 0 0 0 0 .70710678 .70710678\n1 0 1 0 0 0 .70710678 .70710678\n"
    "2 -1 1 0 0 0 .70710678 .70710678\n3 -1 1 1 0 0 .70710678 .70710678\n";

// The files are available to the programs as {truth} and {turned}.
class ProgramsTest : public testing::Test {
 protected:
  ProgramsTest() {
    folder_.Write("truth.txt", kTruth);
    folder_.Write("turned.txt", kTurned);
  }

  // Replaces {name} by the path of name.txt.
  std::string Fill(std::string text) const {
    for (size_t begin; (begin = text.find('{')) != std::string::npos;) {
      const size_t end = text.find('}', begin);
      const std::string name = text.substr(begin + 1, end - begin - 1);
      text.replace(begin, end - begin + 1, folder_ / (name + ".txt"));
    }
    return text;
  }

  RunResult RunFilled(const std::string& command) const {
    return RunCommand(Fill(command), folder_);
  }

  const TempFolder folder_;
};

TEST_F(ProgramsTest, HelpNamesTheFlagsOfTheProgramAlone) {
  const struct {
    std::string program;
    std::vector<std::string> flags;
  } kCases[] = {
      {kEvaluate,
       {"estimate", "groundtruth", "max_time_difference", "rpe_delta_seconds",
        "rpe_delta_metres", "json", "aligned"}},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.program);
    for (const std::string help : {" --help", " -h", " --json --help"}) {
      const RunResult run = RunFilled(c.program + help);
      EXPECT_EQ(run.exit_code, 0);
      EXPECT_EQ(run.err, "");
      EXPECT_THAT(run.out, HasSubstr("Example:"));
      EXPECT_THAT(run.out, HasSubstr("Exit codes:"));
      for (const std::string& flag : c.flags) {
        EXPECT_THAT(run.out, HasSubstr("\n  --" + flag + " ("));
      }
      EXPECT_THAT(run.out, Not(HasSubstr("minloglevel")));  // of glog
      EXPECT_THAT(run.out, Not(HasSubstr("fromenv")));      // of gflags
    }
  }
}

TEST_F(ProgramsTest, EvaluatePrintsATable) {
  const RunResult run =
      RunFilled(kEvaluate + " --estimate={turned} --groundtruth={truth}");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("4 of 4 estimated poses"));
  EXPECT_THAT(run.out, HasSubstr("ATE, rigid alignment, no scale (4 poses)"));
}

TEST_F(ProgramsTest, EvaluatePrintsJson) {
  const RunResult run = RunFilled(
      kEvaluate + " --estimate={turned} --groundtruth={truth} --json");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
  const nlohmann::json json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json.at("paired_poses"), 4);
  EXPECT_EQ(json.at("rpe_seconds").at("count"), 3);
  // The file's quaternion has 8 digits.
  EXPECT_LT(json.at("ate").at("position_m").at("rmse"), 1e-7);
}

TEST_F(ProgramsTest, EvaluateWritesTheAlignedEstimate) {
  const RunResult run = RunFilled(kEvaluate +
                                  " --estimate={turned} --groundtruth={truth} "
                                  "--aligned={aligned}");
  EXPECT_EQ(run.exit_code, 0);
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
