// rgbd_compare from end to end on few frames and seeds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "core/text_file.h"
#include "tests/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

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

  // A camera small enough to be rendered in no time.
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

// Every element is closed and no number is NaN.
void ExpectWellFormedSvg(const std::string& svg, int panels) {
  EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
  const int opened = Count(svg, "<") - Count(svg, "</");
  EXPECT_EQ(opened, Count(svg, "</") + Count(svg, "/>"));
  EXPECT_EQ(Count(svg, "font-weight=\"bold\""), panels);
  EXPECT_EQ(Count(svg, "nan"), 0);
  EXPECT_EQ(Count(svg, "inf"), 0);
}

TEST_F(CompareProgramTest, PanTiltGivesTablesAndFigure) {
  const RunResult run = Compare(
      "--experiment=pan_tilt --frames=6 --losses=none,tukey" + Camera());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, Result("report.md"));
  EXPECT_THAT(run.out, HasSubstr("| truth | 0 | 0 | 0 |"));
  EXPECT_EQ(Count(run.out, "\n| none |"), 2);  // of each table one row
  EXPECT_EQ(Count(run.out, "\n| tukey |"), 2);
  EXPECT_EQ(Count(Result("tables.csv"), "\n"), 3);  // with the header
  ExpectWellFormedSvg(Result("paths.svg"), 2);
}

TEST_F(CompareProgramTest, SweepGivesEveryCell) {
  const RunResult run =
      Compare("--experiment=sweep --seeds=10 --losses=none,tukey");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // 2 losses, 2 schedules, 2 starts, 7 shares, and the header.
  EXPECT_EQ(Count(Result("sweep.csv"), "\n"), 2 * 2 * 2 * 7 + 1);
  ExpectWellFormedSvg(Result("translation.svg"), 2);
  ExpectWellFormedSvg(Result("rotation.svg"), 2);
  EXPECT_THAT(run.out, HasSubstr("tukey has the smallest median"));
  const std::string csv = Result("sweep.csv");
  ASSERT_EQ(
      Compare("--experiment=sweep --seeds=10 --losses=none,tukey").exit_code,
      0);
  EXPECT_EQ(Result("sweep.csv"), csv) << "the same whenever it runs";
}

TEST_F(CompareProgramTest, BadInputIsOneLine) {
  std::filesystem::create_directory(folder_ / "no_truth");
  const std::string no_truth = folder_ / "no_truth";
  for (const std::string& arguments :
       {std::string("--experiment=nonsense"),
        "--camera=tum_fr1 --experiment=" + no_truth,
        std::string("--experiment=xyz --losses=nonsense"),
        std::string("--experiment=sweep --seeds=0")}) {
    const RunResult run = Compare(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_EQ(Count(run.err, "\n"), 1) << run.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

}  // namespace
}  // namespace rgbd_pose
