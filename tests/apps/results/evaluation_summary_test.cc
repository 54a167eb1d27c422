#include "apps/results/evaluation_summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/util/units.h"

namespace rgbd_pose {
namespace {

EvaluationReport SomeReport() {
  EvaluationReport report;
  report.paired_poses = 400;
  report.path_length = 3.0155;
  report.ate = {400, 0.25, 0.2, 0.125, 1.5};
  report.rpe_seconds = {{370, 1.5, 1.4, 1.3, 1.6},
                        {370, kRadiansPerDegree, 0, 0.0, 0.0}};
  report.consistency = {{0.002, 0.2 * kRadiansPerDegree},
                        380,
                        {370, 2, 1.25, 0.875},
                        {375, 3, 1.5, 0.75}};
  report.truth_alignment.fixing.shift = 0.002;
  report.truth_alignment.ate = {398, 0.0125, 0.0, 0.01, 0.05};
  return report;
}

TEST(EvaluationSummaryTest, HasTheErrorsThatPeopleAskFor) {
  EXPECT_EQ(
      FormatEvaluationSummary(SomeReport()),
      "errors of 400 poses, 3.015 m of path          RMSE    median       max\n"
      "  ATE (mm)                                 250.000   125.000  1500.000\n"
      "  RPE over 1 s, translation (mm)          1500.000  1300.000  1600.000\n"
      "  RPE over 1 s, rotation (deg)               1.000     0.000     0.000\n"
      "with the truth's clock (2.0 ms) and its body (0.00 deg) corrected:\n"
      "  ATE (mm)                                  12.500    10.000    50.000\n"
      "  RPE over 1 s, translation (mm)               n/a\n"
      "  RPE over 1 s, rotation (deg)                 n/a\n"
      "covariances of ok frames: 2 of 370 wrong, NEES 1.25 (ground truth: "
      "sigma "
      "2 mm, 0.2 deg)\n");
}

// Stamps that are 5 ms off make every motion wrong, though the path is right.
TEST(EvaluationSummaryTest, SaysThatTheClockMakesFramesWrong) {
  EvaluationReport report = SomeReport();
  const auto has_reason = [&] {
    return FormatEvaluationSummary(report).find(
               "most of them by the truth's clock: with it corrected 1 of 148 "
               "wrong, NEES 1.00") != std::string::npos;
  };
  report.consistency->ok_frames = {148, 147, 30.0, 25.0};
  report.consistency->in_time = {148, 1, 1.0, 0.9};
  EXPECT_TRUE(has_reason());
  report.consistency->in_time = {148, 140, 28.0, 24.0};
  EXPECT_FALSE(has_reason());
}

// Where the clock was not found, for example because rotations of the truth
// have another order of columns, no frame was judged with it.
TEST(EvaluationSummaryTest, DoesNotBlameAClockThatWasNotFound) {
  EvaluationReport report = SomeReport();
  report.truth_alignment.skipped = "too short";
  report.consistency->ok_frames = {148, 147, 30.0, 25.0};
  report.consistency->in_time = {};
  EXPECT_EQ(FormatEvaluationSummary(report).find("by the truth's clock"),
            std::string::npos);
}

TEST(EvaluationSummaryTest, LeavesOutWhatWasNotFound) {
  EvaluationReport report = SomeReport();
  report.truth_alignment.skipped = "too short";
  report.consistency.reset();
  const std::string text = FormatEvaluationSummary(report);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4) << text;
}

}  // namespace
}  // namespace rgbd_pose
