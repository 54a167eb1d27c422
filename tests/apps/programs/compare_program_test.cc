// rgbd_compare from end to end with few frames and seeds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "core/util/text_file.h"
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class CompareProgramTest : public ProgramTest {
 protected:
  RunResult Compare(const std::string& arguments) const {
    return Run(RGBD_COMPARE " --output=" + (folder_ / "results") + " " +
               arguments);
  }

  std::string Result(const std::string& file) const {
    return Read("results/" + file);
  }

  std::string Camera() const {
    return " --camera=" + folder_.Write("camera.yaml", kSmallCamera);
  }
};

TEST_F(CompareProgramTest, PanTiltGivesTables) {
  const RunResult run = Compare(
      "--experiment=pan_tilt --frames=6 --losses=none,tukey" + Camera());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith(Result("report.md")));
  EXPECT_THAT(run.out, HasSubstr("| truth | 0 | 0 | 0 |"));
  EXPECT_EQ(CountOf("\n| none |", run.out), 2);  // one row per table
  EXPECT_EQ(CountOf("\n| tukey |", run.out), 2);
  EXPECT_EQ(CountOf("\n", Result("tables.csv")), 3);  // with the header
  // Either the page is written or the output says why not.
  const bool has_page =
      std::filesystem::exists(folder_ / "results/report.html");
  EXPECT_EQ(CountOf("\nreport in   ", run.out), 1);
  EXPECT_EQ(CountOf("no file: built without plotly.js", run.out), !has_page);
  // The truth and two losses, six frames each.
  EXPECT_EQ(CountOf("\n", Result("paths.csv")), 1 + 3 * 6);
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

constexpr char kName[] = "a \"long\" name";

class CompareFolderTest : public CompareProgramTest {
 protected:
  CompareFolderTest() {
    Render(kName, "--path=xyz --frames=4 --camera=ros_default");
  }

  std::string Sequence() const { return folder_ / kName; }
  std::string Experiment() const {
    return " --losses=none,tukey --experiment='" + Sequence() + "/'";
  }
};

TEST_F(CompareFolderTest, FewFramesOfAFolder) {
  const RunResult run = Compare("--camera=ros_default" + Experiment());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("# M-estimators on a 'long' name\n"));
  EXPECT_THAT(run.out, HasSubstr("## a 'long' name, 5000 raw depth units"));
  EXPECT_EQ(CountOf("| n/a | n/a |", run.out), 2) << "shorter than 1 s";
}

TEST_F(CompareFolderTest, Freiburg2ComesAtBothDepthScales) {
  std::filesystem::remove(Sequence() + "/groundtruth.txt");
  const RunResult run = Compare("--camera=tum_fr2" + Experiment());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(CountOf(", 5000 raw depth units per metre", run.out), 1);
  EXPECT_EQ(CountOf(", 5208 raw depth units per metre", run.out), 1);
  EXPECT_EQ(CountOf("There is no groundtruth.txt", run.out), 2);
  EXPECT_EQ(CountOf("Frames tracked (%): none 100.0, tukey 100.0.", run.out),
            2);
  EXPECT_EQ(CountOf("ATE", run.out), 0);
  EXPECT_EQ(CountOf("\n", Result("tables.csv")), 1 + 2 * 2);
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
    EXPECT_EQ(CountOf("\n| tukey | n/a | n/a | n/a |", run.out), 1);
  }
}

TEST_F(CompareProgramTest, SweepGivesEveryCell) {
  const RunResult run =
      Compare("--experiment=sweep --seeds=10 --losses=none,tukey");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // 2 losses, 2 schedules, 2 starts, 7 shares, and the header.
  EXPECT_EQ(CountOf("\n", Result("sweep.csv")), 2 * 2 * 2 * 7 + 1);
  EXPECT_THAT(run.out, HasSubstr("tukey has the smallest median"));
  const std::string csv = Result("sweep.csv");
  ASSERT_EQ(
      Compare("--experiment=sweep --seeds=10 --losses=none,tukey").exit_code,
      0);
  EXPECT_EQ(Result("sweep.csv"), csv) << "the same whenever it runs";
}

}  // namespace
}  // namespace rgbd_pose
