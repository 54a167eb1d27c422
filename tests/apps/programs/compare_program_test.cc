// rgbd_compare from end to end with few frames and seeds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class CompareProgramTest : public testing::Test {
 protected:
  RunResult Compare(const std::string& arguments) const {
    return RunCommand(std::string(RGBD_COMPARE) + " --output=" +
                          (folder_ / "results") + " " + arguments,
                      folder_);
  }

  std::string Result(const std::string& file) const {
    return ReadTextFile(folder_ / ("results/" + file));
  }

  // A camera small enough to be rendered very quickly.
  std::string Camera() const {
    return " --camera=" +
           folder_.Write(
               "camera.yaml",
               "Camera.fx: 262\nCamera.fy: 262\nCamera.cx: 160\n"
               "Camera.cy: 120\nCamera.width: 320\nCamera.height: 240\n");
  }

  const TempFolder folder_;
};

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (size_t at = text.find(part); at != std::string::npos;
       at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

TEST_F(CompareProgramTest, PanTiltGivesTables) {
  const RunResult run = Compare(
      "--experiment=pan_tilt --frames=6 --losses=none,tukey" + Camera());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith(Result("report.md")));
  EXPECT_THAT(run.out, HasSubstr("| truth | 0 | 0 | 0 |"));
  EXPECT_EQ(Count(run.out, "\n| none |"), 2);  // one row per table
  EXPECT_EQ(Count(run.out, "\n| tukey |"), 2);
  EXPECT_EQ(Count(Result("tables.csv"), "\n"), 3);  // with the header
  // Either the page is written or the output says why not.
  const bool has_page =
      std::filesystem::exists(folder_ / "results/report.html");
  EXPECT_EQ(Count(run.out, "\nreport in   "), 1);
  EXPECT_EQ(Count(run.out, "no file: built without plotly.js"), !has_page);
  // The truth and two losses, six frames each.
  EXPECT_EQ(Count(Result("paths.csv"), "\n"), 1 + 3 * 6);
}

TEST_F(CompareProgramTest, ARunCanBeRepeatedFromItsFlags) {
  const std::string arguments =
      "--experiment=xyz --frames=3 --losses=none --noreport" + Camera();
  ASSERT_EQ(Compare(arguments).exit_code, 0);
  const std::string tables = Result("tables.csv");
  std::filesystem::remove(folder_ / "results/tables.csv");
  ASSERT_EQ(
      Compare("--flagfile=" + (folder_ / "results/config.flags")).exit_code, 0);
  EXPECT_EQ(Result("tables.csv"), tables);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results/report.html"));
}

class CompareFolderTest : public CompareProgramTest {
 protected:
  void SetUp() override {
    const RunResult run =
        RunCommand(std::string(RGBD_SIMULATE) +
                       " --path=xyz --frames=4 --output='" + Sequence() + "'",
                   folder_);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  std::string Sequence() const { return folder_ / "a \"long\" name"; }
  std::string Experiment() const {
    return " --losses=none,tukey --experiment='" + Sequence() + "/'";
  }
};

TEST_F(CompareFolderTest, FewFramesOfAFolder) {
  const RunResult run = Compare("--camera=ros_default" + Experiment());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("# M-estimators on a 'long' name\n"));
  EXPECT_THAT(run.out, HasSubstr("## a 'long' name, 5000 raw depth units"));
  EXPECT_EQ(Count(run.out, "| n/a | n/a |"), 2) << "shorter than 1 s";
}

TEST_F(CompareFolderTest, Freiburg2ComesAtBothDepthScales) {
  std::filesystem::remove(Sequence() + "/groundtruth.txt");
  const RunResult run = Compare("--camera=tum_fr2" + Experiment());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Count(run.out, ", 5000 raw depth units per metre"), 1);
  EXPECT_EQ(Count(run.out, ", 5208 raw depth units per metre"), 1);
  EXPECT_EQ(Count(run.out, "There is no groundtruth.txt"), 2);
  EXPECT_EQ(Count(run.out, "Frames tracked (%): none 100.0, tukey 100.0."), 2);
  EXPECT_EQ(Count(run.out, "ATE"), 0);
  EXPECT_EQ(Count(Result("tables.csv"), "\n"), 1 + 2 * 2);
}

TEST_F(CompareFolderTest, AllFramesLost) {
  // A depth factor that makes all depths almost 0.
  const std::string camera = folder_.Write(
      "camera.yaml",
      "Camera.fx: 525\nCamera.fy: 525\nCamera.cx: 319.5\nCamera.cy: 239.5\n"
      "Camera.width: 640\nCamera.height: 480\nDepthMapFactor: 5000000\n");
  for (const bool truth : {true, false}) {
    if (!truth) std::filesystem::remove(Sequence() + "/groundtruth.txt");
    const RunResult run = Compare("--camera=" + camera + Experiment());
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_THAT(run.out, HasSubstr(", 5000000 raw depth units"));
    EXPECT_EQ(Count(run.out, "\n| tukey | n/a | n/a | n/a |"), 1);
  }
}

TEST_F(CompareProgramTest, SweepGivesEveryCell) {
  const RunResult run =
      Compare("--experiment=sweep --seeds=10 --losses=none,tukey");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // 2 losses, 2 schedules, 2 starts, 7 shares, and the header.
  EXPECT_EQ(Count(Result("sweep.csv"), "\n"), 2 * 2 * 2 * 7 + 1);
  EXPECT_THAT(run.out, HasSubstr("tukey has the smallest median"));
  const std::string csv = Result("sweep.csv");
  ASSERT_EQ(
      Compare("--experiment=sweep --seeds=10 --losses=none,tukey").exit_code,
      0);
  EXPECT_EQ(Result("sweep.csv"), csv) << "the same whenever it runs";
}

}  // namespace
}  // namespace rgbd_pose
