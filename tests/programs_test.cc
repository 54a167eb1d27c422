// Runs the built programs: their exit codes and what they say where.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/text_file.h"
#include "core/trajectory.h"
#include "tests/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kEvaluate = RGBD_EVALUATE;

constexpr char kTruth[] =
    "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 1 1 0 0 0 0 1\n3 1 1 1 0 0 0 1\n";
// The truth from a world that is turned by 90 degrees about z.
constexpr char kTurned[] =
    "0 0 0 0 0 0 .70710678 .70710678\n1 0 1 0 0 0 .70710678 .70710678\n"
    "2 -1 1 0 0 0 .70710678 .70710678\n3 -1 1 1 0 0 .70710678 .70710678\n";

// Files for the programs to read, as {truth}, {turned} and so on; {none} is in
// the folder of the test but does not exist.
class ProgramsTest : public testing::Test {
 protected:
  ProgramsTest() {
    folder_.Write("truth.txt", kTruth);
    folder_.Write("turned.txt", kTurned);
    folder_.Write("broken.txt", "0 0 0 0 0 0 0 1\n1 oops 0 0 0 0 0 1\n");
    folder_.Write("later.txt", "100 0 0 0 0 0 0 1\n");
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

// Bad calls: a code, one line on stderr, nothing on stdout.
TEST_F(ProgramsTest, BadCallsEndWithOneLine) {
  const struct {
    const char* what;
    std::string command;
    int exit_code;
    std::string message;
  } kCases[] = {
      {"evaluate: no flags", kEvaluate, 1, "--estimate is needed"},
      {"evaluate: no truth", kEvaluate + " --estimate={turned}", 1,
       "--groundtruth is needed"},
      {"evaluate: unknown flag", kEvaluate + " --estimates={turned}", 2,
       "unknown flag --estimates"},
      {"evaluate: no flag at all", kEvaluate + " {turned} {truth}", 2,
       "{turned}' is no flag"},
      {"evaluate: no number",
       kEvaluate + " --estimate={turned} --groundtruth={truth} "
                   "--max_time_difference=soon",
       2, "'soon' is no double for --max_time_difference"},
      {"evaluate: no estimate file",
       kEvaluate + " --estimate={none} --groundtruth={truth}", 2, "{none}: "},
      {"evaluate: no truth file",
       kEvaluate + " --estimate={turned} --groundtruth={none}", 2, "{none}: "},
      {"evaluate: broken line",
       kEvaluate + " --estimate={broken} --groundtruth={truth}", 2,
       "{broken}:2: 'oops'"},
      {"evaluate: another time",
       kEvaluate + " --estimate={later} --groundtruth={truth}", 2,
       "(100.000000 s to 100.000000 s)"},
      {"evaluate: negative tolerance",
       kEvaluate + " --estimate={turned} --groundtruth={truth} "
                   "--max_time_difference=-1",
       2, "must not be negative"},
      {"evaluate: no folder for the result",
       kEvaluate + " --estimate={turned} --groundtruth={truth} "
                   "--aligned={no/folder}",
       2, "{no/folder}: cannot be written"},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.what);
    const RunResult run = RunFilled(c.command);
    EXPECT_EQ(run.exit_code, c.exit_code);
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, HasSubstr(Fill(c.message)));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
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
