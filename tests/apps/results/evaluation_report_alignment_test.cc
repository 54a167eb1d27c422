#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "apps/results/evaluation_report.h"
#include "core/geometry/twist.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

using testing::EndsWith;

EvaluationReport SomeReport() {
  EvaluationReport report;
  TruthAlignment& alignment = report.truth_alignment;
  alignment.motions = 753;
  const Twist turn{kRadiansPerDegree * Vector3d(1.5, 0.0, -0.25),
                   Vector3d::Zero()};
  alignment.fixing = {-0.0075, Rigid3d(turn.MotionDuring(-1.0).rotation,
                                       {-0.01, 0.004, -1e-9})};
  alignment.sigma << 0.0004, Vector3d::Constant(0.125 * kRadiansPerDegree),
      0.002, 0.003, std::numeric_limits<double>::infinity();
  alignment.undetermined = {"lever along (0.00, 0.00, 1.00)"};
  alignment.ate = {790, 0.25, 0.2, 0.125, 1.5};
  alignment.rpe_seconds = {{751, 1.5, 1.4, 1.3, 1.6}, {}};
  return report;
}

TEST(TruthAlignmentReportTest, TableHasEstimatesWithTheirErrors) {
  EXPECT_THAT(
      FormatEvaluation(SomeReport()),
      EndsWith(
          "\n"
          "Best time shift of the ground truth and its body in the camera (753 "
          "motions)\n"
          "  time shift (ms)                      -7.5 +- 0.4\n"
          "  rotation x, y, z (deg)              1.50 +- 0.12      0.00 +- "
          "0.12    "
          " "
          "-0.25 +- 0.12\n"
          "  lever x, y, z (mm)                  -10.0 +- 2.0        4.0 +- "
          "3.0    "
          "  "
          "         n/a\n"
          "  not determined by the motion: lever along (0.00, 0.00, 1.00)\n"
          "                                        RMSE      median        mean"
          "         max\n"
          "ATE, after this correction (790 poses)\n"
          "  position (mm)                     250.0000    125.0000    200.0000"
          "   1500.0000\n"
          "RPE, after this correction, fixed delta 1 s (751 pairs)\n"
          "  translation (mm)                 1500.0000   1300.0000   1400.0000"
          "   1600.0000\n"
          "  rotation (deg)                         n/a\n"));
}

TEST(TruthAlignmentReportTest, JsonHasTheSameFigures) {
  const nlohmann::json json =
      EvaluationToJson(SomeReport()).at("truth_alignment");
  EXPECT_TRUE(json.at("skipped").is_null());
  EXPECT_EQ(json.at("motions"), 753);
  EXPECT_EQ(json.at("undetermined").at(0), "lever along (0.00, 0.00, 1.00)");
  EXPECT_EQ(json.at("time_shift_s"), -0.0075);
  EXPECT_EQ(json.at("time_shift_sigma_s"), 0.0004);
  EXPECT_NEAR(json.at("rotation_deg").at(0), 1.5, 1e-12);
  EXPECT_NEAR(json.at("rotation_sigma_deg").at(2), 0.125, 1e-12);
  EXPECT_EQ(json.at("lever_m").at(1), 0.004);
  EXPECT_EQ(json.at("lever_sigma_m").at(1), 0.003);
  EXPECT_EQ(json.at("lever_sigma_m").at(2).dump(), "null");
  EXPECT_EQ(json.at("ate").at("position_m").at("rmse"), 0.25);
  EXPECT_EQ(json.at("rpe_seconds").at("translation_m").at("rmse"), 1.5);
  EXPECT_TRUE(json.at("rpe_seconds").at("rotation_deg").is_null());
}

TEST(TruthAlignmentReportTest, OneLineWhereThereIsNone) {
  EvaluationReport report;
  report.truth_alignment.skipped = "too short";
  EXPECT_THAT(FormatEvaluation(report),
              EndsWith("\nBest time shift of the ground truth and its body in "
                       "the camera: not "
                       "estimated; too short\n"));
  const nlohmann::json json = EvaluationToJson(report).at("truth_alignment");
  EXPECT_EQ(json.at("skipped"), "too short");
  EXPECT_FALSE(json.contains("time_shift_s"));
}

}  // namespace
}  // namespace rgbd_pose
