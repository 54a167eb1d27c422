// report.html from end to end: a simulated run, its page, a real browser.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/util/text_file.h"
#include "tests/support/browser.h"
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

// Limit for a page that can still be sent by e-mail.
constexpr size_t kMaxPageBytes = 3'000'000;
// A PNG of a blank window of this size has a tenth of this.
constexpr size_t kMinScreenshotBytes = 40'000;
// A class of each plot that was drawn.
constexpr char kPlot[] = " js-plotly-plot\"";

class ReportTest : public ProgramTest {
 protected:
  void SetUp() override {
    // Without plotly.js the program reports that first, whatever the folder.
    const RunResult probe = Run(RGBD_REPORT " --run=" + (folder_ / "none"));
    if (probe.err.find("built without plotly.js") != std::string::npos) {
      GTEST_SKIP() << "built without plotly.js";
    }
  }

  void Simulate(const std::string& flags = "") const {
    Render("sequence", "--path=xyz --frames=16 " + flags);
  }

  std::string Sequence() const { return folder_ / "sequence"; }
  std::string Page() const { return folder_ / "run/report.html"; }

  void Track(const std::string& more = "") {
    const RunResult run = Run(
        RGBD_ODOMETRY " --dataset=" + Sequence() + " --camera=" + Sequence() +
        "/camera.yaml --output=" + (folder_ / "run") + more);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  // Opens the page of the run in the browser; `action` is a list of its flags.
  RunResult Browse(const std::string& action) const {
    return rgbd_pose::Browse(Page(), action, folder_);
  }

  // Opens the page, which must be drawn without complaints; returns its
  // elements.
  std::string Drawn(int width = 1280, const std::string& action = "") const {
    const RunResult browser = Browse("--window-size=" + std::to_string(width) +
                                     ",4000 --dump-dom " + action);
    EXPECT_EQ(Console(browser), "");
    EXPECT_THAT(browser.out, HasSubstr("data-done=\"true\""));
    return browser.out;
  }

  // Expects exactly these plots on narrow and on wide screens.
  void ExpectPlots(const std::vector<std::string>& ids) const {
    const std::string image = folder_ / "page.png";
    for (const int width : {390, 1280}) {
      const std::string page = Drawn(width, "--screenshot=" + image);
      for (const std::string& id : ids) {
        EXPECT_EQ(CountOf("<div id=\"" + id + "\"", page), 1) << id;
      }
      EXPECT_EQ(CountOf(kPlot, page), static_cast<int>(ids.size()));
    }
    ASSERT_TRUE(std::filesystem::exists(image));
    EXPECT_GT(std::filesystem::file_size(image), kMinScreenshotBytes);
  }
};

TEST_F(ReportTest, APageIsSmallAndNeedsNothingElse) {
  Simulate();
  Track();
  const std::string page = ReadTextFile(Page());
  EXPECT_LT(page.size(), kMaxPageBytes);
  EXPECT_THAT(page, Not(HasSubstr("<script src")));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
  EXPECT_THAT(page, HasSubstr("Permission is hereby granted"));  // the licence

  std::filesystem::remove(Page());
  const RunResult again = Run(RGBD_REPORT " --run=" + (folder_ / "run"));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr(Page()));
  EXPECT_TRUE(ReadTextFile(Page()) == page) << "not the page of the run";
}

TEST_F(ReportTest, ARunMayHaveNone) {
  Simulate();
  Track(" --noreport");
  EXPECT_FALSE(std::filesystem::exists(Page()));
}

TEST_F(ReportTest, ABrowserDrawsAllPlots) {
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  Simulate();
  Track();
  ExpectPlots({"path-xy", "path-xz", "path-3d", "errors", "tracking", "times",
               "residuals", "weights"});
}

TEST_F(ReportTest, WithoutGroundTruthThereAreNoErrors) {
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  Simulate();
  std::filesystem::remove(Sequence() + "/groundtruth.txt");
  Track();
  const std::string drawn = Drawn(390);
  EXPECT_EQ(CountOf("<div id=\"errors\"", drawn), 0);
  EXPECT_EQ(CountOf(kPlot, drawn), 7);
}

TEST_F(ReportTest, ABatchIsComparedOnOnePage) {
  folder_.Write(
      "run/summary.csv",
      "sequence,cost,loss,frontend,tracker,part,repeat,status,folder,frames,"
      "tracked_share,ate_rmse_m,rpe_seconds_translation_m,"
      "rpe_seconds_rotation_deg,track_ms_median\n"
      "kitchen,point,huber,patch,hybrid,0-,1,ok,kitchen/"
      "a-r1,400,1,0.03,0.02,1.1,1.2\n"
      "kitchen,point,huber,patch,hybrid,3-,1,ok,10:05 #1/b-r1,397,1,0.05,0.02,"
      "1.1,1.2\n"
      "kitchen,point,tukey,patch,hybrid,0-,1,ok,kitchen/"
      "c-r1,400,1,0.04,0.03,1.2,1.3\n"
      "hall,point,huber,patch,hybrid,0-,1,ok,hall/a-r1,50,1,,,,1.2\n"
      "hall,point,tukey,patch,hybrid,0-,1,failed,hall/c-r1,,,,,,\n");
  folder_.Write("run/10:05 #1/b-r1/report.html", "");
  const RunResult report = Run(RGBD_REPORT " --batch=" + (folder_ / "run"));
  ASSERT_EQ(report.exit_code, 0) << report.err;
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  const std::string drawn = Drawn(390);
  EXPECT_EQ(CountOf(kPlot, drawn), 4);
  EXPECT_EQ(CountOf(">failed</td>", drawn), 1);
  EXPECT_EQ(CountOf("<a href=", drawn), 1);  // to the only report
  EXPECT_THAT(drawn, HasSubstr("<a href=\"10%3A05%20%231/b-r1/report.html\">"));
  EXPECT_THAT(drawn, HasSubstr("40.0 (30.0 to 50.0)"));  // of two parts
}

TEST_F(ReportTest, TheCloudIsShownBesideThePath) {
  Simulate();
  Track(" --save_cloud=" + (folder_ / "run/cloud.ply"));
  const std::string page = ReadTextFile(Page());
  EXPECT_LT(page.size(), kMaxPageBytes);
  EXPECT_THAT(page, HasSubstr("\"colors\":\""));
  std::filesystem::remove(folder_ / "run/cloud.ply");  // may be elsewhere
  ASSERT_EQ(Run(RGBD_REPORT " --run=" + (folder_ / "run")).exit_code, 0);
  EXPECT_TRUE(ReadTextFile(Page()) == page) << "not the page of the run";
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  const std::string drawn = Drawn();
  EXPECT_EQ(CountOf(kPlot, drawn), 8);
  EXPECT_THAT(drawn, HasSubstr(">Point cloud: "));
  EXPECT_THAT(drawn, HasSubstr(">point cloud</text>"));  // the legend
}

TEST_F(ReportTest, TheMeshIsShownBesideThePathUntilTheNextRun) {
  Simulate();
  Track(" --voxel=0.03 --save_mesh=" + (folder_ / "run/mesh.glb"));
  const std::string page = ReadTextFile(Page());
  EXPECT_LT(page.size(), kMaxPageBytes);
  EXPECT_THAT(page, HasSubstr("\"corners\":\""));
  if (HasBrowser()) {
    const std::string drawn = Drawn();
    EXPECT_THAT(drawn, HasSubstr(">Mesh: "));
    EXPECT_THAT(drawn, HasSubstr(">mesh</text>"));
  }
  // Adding the mesh later gives the same page.
  const RunResult later =
      Run(RGBD_EXPORT " --to=mesh --voxel=0.03 --run=" + (folder_ / "run") +
          " --output=" + (folder_ / "run/mesh.glb"));
  EXPECT_EQ(later.exit_code, 0) << later.err;
  EXPECT_TRUE(ReadTextFile(Page()) == page);
  Track();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run/mesh_preview.json"));
  EXPECT_THAT(ReadTextFile(Page()), Not(HasSubstr("\"corners\":\"")));
}

// A map as rgbd_slam writes it: three keyframes and a removed one.
TEST_F(ReportTest, TheMapOfARunIsShown) {
  Simulate();
  Track();
  const std::string metrics = ReadTextFile(folder_ / "run/metrics.json");
  const auto write = [&](const std::string& slam) {
    folder_.Write(
        "run/metrics.json",
        "{\"slam\": " + slam + "," + metrics.substr(metrics.find('{') + 1));
    const RunResult report = Run(RGBD_REPORT " --run=" + (folder_ / "run"));
    EXPECT_EQ(report.exit_code, 0) << report.err;
  };
  folder_.Write("run/trajectory_odometry.txt",
                ReadTextFile(folder_ / "run/trajectory.txt"));
  write(R"({"keyframes": 3, "keyframes_dropped": 1, "tracked_pairs": 2,
            "pairs": 1, "loops": 1, "segments_joined": 0,
            "unsolved": 2, "error": "pose 3 is not finite",
            "graph_keyframes": [[0, 0, 0, 0, false], [0, 0, 1, 0, true],
                                [1, 0, 1, 0, false], [1, 0, 0, 0, false]],
            "graph_pairs": [[0, 2, 0], [2, 3, 0], [0, 3, 2]]})");
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  const std::string drawn = Drawn();
  EXPECT_EQ(CountOf("<div id=\"map\"", drawn), 1);
  EXPECT_THAT(drawn, HasSubstr("3 keyframes (1 more removed"));
  EXPECT_THAT(drawn, HasSubstr("2 times; last reason: pose 3 is not"));
  for (const std::string name :
       {"odometry path", "final path", "tracked pairs (2)", "loops (1)",
        "removed (1)", "keyframes (3)"}) {
    EXPECT_EQ(CountOf(">" + name + "</text>", drawn), 1) << name;
  }
  EXPECT_EQ(CountOf("further pairs", drawn), 1);  // only in the script
  EXPECT_THAT(drawn, HasSubstr("up to 0 mm from the odometry path"));
  EXPECT_THAT(drawn, HasSubstr("rgbd_slam --flagfile=" +
                               (folder_ / "run/config.flags")));

  write("{}");  // nothing to draw
  const std::string empty = Drawn();
  EXPECT_EQ(CountOf("<div id=\"map\"", empty), 0);
}

// rgbd_report writes the page of a comparison again from rgbd_compare's files.
class ComparisonReportTest : public ReportTest {
 protected:
  void Compare(const std::string& arguments) {
    const RunResult run =
        Run(RGBD_COMPARE " --losses=none,tukey --output=" + (folder_ / "run") +
            " " + arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("report in   " + Page()));
    const std::string page = ReadTextFile(Page());
    EXPECT_LT(page.size(), kMaxPageBytes);
    std::filesystem::remove(Page());
    const RunResult again =
        Run(RGBD_REPORT " --comparison=" + (folder_ / "run"));
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_TRUE(ReadTextFile(Page()) == page) << "not the same page";
  }
};

TEST_F(ComparisonReportTest, OfASequenceWithTruth) {
  Simulate("--camera=ros_default");
  Compare("--camera=ros_default --experiment=" + Sequence());
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  ExpectPlots({"s0-path-xy", "s0-path-xz", "s0-path-3d", "s0-figures-mm",
               "s0-figures-deg", "s0-errors"});
}

TEST_F(ComparisonReportTest, WithoutTruthAtTwoDepthScales) {
  Simulate("--camera=ros_default");
  std::filesystem::remove(Sequence() + "/groundtruth.txt");
  Compare("--camera=tum_fr2 --experiment=" + Sequence());
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  ExpectPlots({"s0-path-xy", "s0-path-xz", "s0-path-3d", "s1-path-xy",
               "s1-path-xz", "s1-path-3d"});
}

TEST_F(ComparisonReportTest, OfASweep) {
  Compare("--experiment=sweep --seeds=10");
  if (!HasBrowser()) GTEST_SKIP() << "no chromium";
  ExpectPlots({"sweep-translation", "sweep-rotation"});

  // Selects another variant of the losses, as a user would.
  const auto table = [](const RunResult& browser) {
    const size_t begin = browser.out.find("<tbody>");
    return browser.out.substr(begin, browser.out.find("</tbody>") - begin);
  };
  const std::string before = table(Browse("--dump-dom"));
  EXPECT_THAT(before, HasSubstr(">tukey<"));
  folder_.Write("run/report.html",
                ReadTextFile(Page()) +
                    "<script>const method = document.getElementById('method');"
                    "method.value = '2';"
                    "method.dispatchEvent(new Event('change'));</script>");
  const RunResult changed = Browse("--dump-dom");
  EXPECT_EQ(Console(changed), "");
  EXPECT_THAT(table(changed), HasSubstr(">tukey<"));
  EXPECT_NE(table(changed), before);
}

}  // namespace
}  // namespace rgbd_pose
