#include "apps/report/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/report/report_data.h"
#include "frontend/calibration/calibration_result.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// Writes a run with `frames` frames; every seventh is lost and one takes 50 ms.
void WriteRun(const TempFolder& folder, int frames) {
  std::string csv =
      "timestamp,status,reason,segment,reference,is_reference,relocalised,"
      "tracking_source,matches,inliers,iterations,sigma,decode_ms,track_ms,"
      "match_ms,solve_ms,"
      "reference_ms,relocalise_ms\n";
  std::string poses;
  for (int i = 0; i < frames; ++i) {
    const bool lost = i % 7 == 6;
    const std::string time = std::to_string(100.0 + i / 32.0);
    csv += time + (lost ? ",lost,\"too few, all\"" : ",ok,\"\"") +
           (i == 5 ? ",0,0,0,0,direct" : ",0,0,0,0,features") +
           ",300,250,3,1.01,2.5," + (i == 13 ? "50" : "1.25") + ",1,0.1,0,0\n";
    if (!lost) poses += time + " 0.1 0.2 " + std::to_string(i) + " 0 0 0 1\n";
  }
  folder.Write("frames.csv", csv);
  folder.Write("trajectory.txt", poses);
  folder.Write("config.flags",
               "# Input\n--dataset=a=b\n# Estimation\n"
               "--cost=bidirectional_point\n--loss=huber\n");
  folder.Write("metrics.json",
               R"({"residuals": {"degrees_counts": [0, 0, 1, 9, 0, 0, 0]}})");
}

TEST(RunReportData, LostFramesAreGaps) {
  const TempFolder folder;
  WriteRun(folder, 15);
  const json data = RunReportData(folder.path());
  EXPECT_EQ(data.at("every"), 1);
  EXPECT_EQ(data.at("frames").at("t")[1], 0.0313);  // 1/32 s, rounded
  EXPECT_EQ(data.at("frames").at("status")[5], 0);
  EXPECT_EQ(data.at("frames").at("status")[6], 2);
  EXPECT_EQ(data.at("frames").at("by_pixels")[4], 0);
  EXPECT_EQ(data.at("frames").at("by_pixels")[5], 1);
  const json& z = data.at("path").at("z");
  ASSERT_EQ(z.size(), 15u);
  EXPECT_EQ(z[5], 5.0);
  EXPECT_EQ(z[6].dump(), "null");
  EXPECT_EQ(z[7], 7.0);
  ASSERT_EQ(data.at("incidents").size(), 2u);
  EXPECT_EQ(data.at("incidents")[1].at("first"), 13);
  EXPECT_EQ(data.at("incidents")[1].at("reason"), "too few, all");
  EXPECT_FALSE(data.contains("errors"));
  EXPECT_EQ(data.at("settings")[0].dump(), R"(["Input",[["dataset","a=b"]]])");
}

TEST(RunReportData, TheLossIsThatOfTheRun) {
  const TempFolder folder;
  WriteRun(folder, 1);
  const json loss = RunReportData(folder.path()).at("loss");
  EXPECT_EQ(loss.at("name"), "huber");
  const double width = loss.at("width");
  const double step = loss.at("step");
  const json& weights = loss.at("weights");
  EXPECT_EQ(weights[0], 1.0);
  const double x = step * (weights.size() - 1);
  ASSERT_GT(x, width);
  EXPECT_NEAR(weights.back(), width / x, 1e-4);  // four decimals
}

TEST(RunReportData, LongRunsAreThinnedWithoutLosingPeaks) {
  const TempFolder folder;
  WriteRun(folder, 3 * kMaxReportPoints - 1);
  const json data = RunReportData(folder.path());
  EXPECT_EQ(data.at("every"), 3);
  const json& times = data.at("frames").at("track_ms");
  EXPECT_EQ(times.size(), static_cast<size_t>(kMaxReportPoints));
  EXPECT_EQ(times[4], 50.0);  // frames 12 to 14
  EXPECT_EQ(data.at("frames").at("status")[2], 2);
}

TEST(RunReportData, TakesTheCloudOfTheRun) {
  const TempFolder folder;
  WriteRun(folder, 3);
  EXPECT_FALSE(RunReportData(folder.path()).contains("cloud"));
  folder.Write("cloud_preview.json", R"({"points": 1})");
  EXPECT_EQ(RunReportData(folder.path()).at("cloud").at("points"), 1);
  folder.Write("cloud_preview.json", "[]");
  ExpectInputError([&] { RunReportData(folder.path()); },
                   {"cloud_preview.json"});
}

// A landmark at infinity has no known motion: JSON knows no NaN.
TEST(CalibrationPage, HasTheResidualsOfHeldOutViews) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CalibrationResult result;
  result.residuals = {{10.2, 4.0, {0.5, 0.0}, {0.1, 0.0}, {100.04, nan}},
                      {10.2, 4.0, {50.0, 0.0}, {0.1, 0.0}, {0.0, 0.0}}};
  const std::string page = CalibrationPage(result, {});
  EXPECT_THAT(page, HasSubstr("data-kind=\"calibration\""));
  EXPECT_THAT(
      page, HasSubstr("\"residuals\":[[10.0,4.0,0.5,0.0,0.1,0.0,100.0,null]]"))
      << "without the wrong match";
}

TEST(ReportPage, WordsOfTheDataCannotEndItsScript) {
  const json data = {{"dataset", "</script><!--<b>&\xff"}};
  const std::string page = ReportPage("run", data);
  EXPECT_THAT(page, HasSubstr("\\u003c/script>\\u003c!--\\u003cb>&"));
  EXPECT_THAT(page, HasSubstr("data-kind=\"run\""));
  EXPECT_THAT(page, Not(HasSubstr("%DATA%")));
  EXPECT_THAT(page, Not(HasSubstr("%SCRIPT%")));
}

}  // namespace
}  // namespace rgbd_pose
