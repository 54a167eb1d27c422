#include "apps/results/evaluation_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

constexpr double kHalfTurn = 3.14159265358979323846;

EvaluationReport MakeReport() {
  EvaluationReport report;
  report.estimated_poses = 500;
  report.paired_poses = 400;
  report.duration = 13.3;
  report.path_length = 3.0155;
  report.ate = {400, 0.25, 0.2, 0.125, 1.5};
  report.rpe_frame = {{399, 0.5, 0.4, 0.3, 0.6}, {399, kHalfTurn, 0, 0, 0}};
  report.rpe_seconds = {{370, 1.5, 1.4, 1.3, 1.6, 1.45, 1.55},
                        {370, 0, kHalfTurn / 2, kHalfTurn / 4, kHalfTurn}};
  report.sim3 = {1.02, 2.0, 0.12};
  report.final_pose = {0.75, kHalfTurn / 180};
  report.options.rpe_frames = {1, 500};
  report.rpe_frames = {{{399, 0, 0, 0.0125, 0, 0.05, 0.25},
                        {399, 0, 0, kHalfTurn / 360, 0, kHalfTurn, 0}},
                       {}};
  report.consistency = {{0.002, kHalfTurn / 900},
                        380,
                        {370, 2, 1.25, 0.875},
                        {375, 3, 1.5, 0.75}};
  report.truth_alignment.skipped = "too short";
  return report;
}

TEST(EvaluationReportTest, TableSaysWhatIsMeasuredAndHow) {
  EXPECT_EQ(
      FormatEvaluation(MakeReport()),
      "400 of 500 estimated poses have a ground truth within 0.02 s;\n"
      "they span 13.300 s and 3.015 m of path.\n"
      "\n"
      "                                        RMSE      median        mean"
      "         max\n"
      "ATE, rigid alignment, no scale (400 poses)\n"
      "  position (mm)                     250.0000    125.0000    200.0000"
      "   1500.0000\n"
      "    with scale                      120.0000  if scaled by 1.02000\n"
      "RPE, fixed delta 1 frame, consecutive poses (399 pairs)\n"
      "  translation (mm)                  500.0000    300.0000    400.0000"
      "    600.0000\n"
      "  rotation (deg)                    180.0000      0.0000      0.0000"
      "      0.0000\n"
      "RPE, fixed delta 1 s (370 pairs)\n"
      "  translation (mm)                 1500.0000   1300.0000   1400.0000"
      "   1600.0000\n"
      "  rotation (deg)                      0.0000     45.0000     90.0000"
      "    180.0000\n"
      "RPE, fixed delta 1 m of ground-truth path (0 pairs)\n"
      "  translation (mm)                       n/a\n"
      "  rotation (deg)                         n/a\n"
      "Final pose error, last pose relative to the first\n"
      "  translation (mm)                  750.0000\n"
      "  rotation (deg)                      1.0000\n"
      "\n"
      "                                      median        90 %        99 %\n"
      "RPE, fixed delta 1 frame (399 pairs)\n"
      "  translation (mm)                   12.5000     50.0000    250.0000\n"
      "  rotation (deg)                      0.5000    180.0000      0.0000\n"
      "RPE, fixed delta 500 frames (0 pairs)\n"
      "  translation (mm)                       n/a\n"
      "  rotation (deg)                         n/a\n"
      "RPE, fixed delta 1 s (370 pairs)\n"
      "  translation (mm)                 1300.0000   1450.0000   1550.0000\n"
      "  rotation (deg)                     45.0000      0.0000      0.0000\n"
      "\n"
      "Errors and covariances (ground truth: sigma 2 mm, 0.2 deg)\n"
      "                                   evaluated       wrong        NEES"
      "      median\n"
      "  frames, of 380 ok                      370           2        1.25"
      "        0.88\n"
      "  all motions                            375           3        1.50"
      "        0.75\n"
      "\n"
      "Best time shift of the ground truth and its body in the camera: not "
      "estimated; too "
      "short\n");
}

TEST(EvaluationReportTest, JsonHasTheSameFigures) {
  const nlohmann::json json = EvaluationToJson(MakeReport());
  EXPECT_EQ(json.at("estimated_poses"), 500);
  EXPECT_EQ(json.at("paired_poses"), 400);
  EXPECT_EQ(json.at("duration_s"), 13.3);
  EXPECT_EQ(json.at("with_scale").at("truth_per_estimate"), 1.02);
  EXPECT_EQ(json.at("with_scale").at("position_rmse_m"), 0.12);
  EXPECT_EQ(json.at("path_length_m"), 3.0155);
  EXPECT_EQ(json.at("max_time_difference_s"), 0.02);
  EXPECT_EQ(json.at("ate").at("definition"), "rigid alignment, no scale");
  EXPECT_EQ(json.at("ate").at("position_m").at("rmse"), 0.25);
  EXPECT_EQ(json.at("ate").at("position_m").at("median"), 0.125);
  const nlohmann::json& seconds = json.at("rpe_seconds");
  EXPECT_EQ(seconds.at("count"), 370);
  EXPECT_EQ(seconds.at("delta"), 1.0);
  EXPECT_EQ(seconds.at("translation_m").at("rmse"), 1.5);
  EXPECT_DOUBLE_EQ(seconds.at("rotation_deg").at("mean"), 90.0);
  EXPECT_DOUBLE_EQ(json.at("rpe_frame").at("rotation_deg").at("rmse"), 180.0);
  const nlohmann::json& frame = json.at("rpe_frames").at(0);
  EXPECT_EQ(frame.at("frames"), 1);
  EXPECT_EQ(frame.at("count"), 399);
  EXPECT_DOUBLE_EQ(frame.at("translation_mm").at("median"), 12.5);
  EXPECT_DOUBLE_EQ(frame.at("translation_mm").at("p99"), 250.0);
  EXPECT_DOUBLE_EQ(frame.at("rotation_deg").at("p90"), 180.0);
  EXPECT_TRUE(json.at("rpe_frames").at(1).at("translation_mm").is_null());
  EXPECT_EQ(seconds.at("translation_m").at("p99"), 1.55);
  const nlohmann::json& consistency = json.at("consistency");
  EXPECT_EQ(consistency.at("wrong_above_chi_square"), 40.9);
  EXPECT_DOUBLE_EQ(consistency.at("truth_sigma_deg"), 0.2);
  EXPECT_EQ(consistency.at("ok"), 380);
  EXPECT_EQ(consistency.at("ok_frames").at("wrong"), 2);
  EXPECT_EQ(consistency.at("edges").at("nees"), 1.5);
  EXPECT_EQ(json.at("truth_alignment").at("skipped"), "too short");
  EXPECT_EQ(json.at("final_pose").at("translation_m"), 0.75);
  EXPECT_DOUBLE_EQ(json.at("final_pose").at("rotation_deg"), 1.0);
}

TEST(EvaluationReportTest, SaysWhenTheTruthIsAssumedToBeExact) {
  EvaluationReport report = MakeReport();
  report.consistency->truth_noise = {};
  EXPECT_NE(FormatEvaluation(report).find("(ground truth: assumed exact)"),
            std::string::npos);
}

TEST(EvaluationReportTest, NothingToMeasureIsNull) {
  EvaluationReport report = MakeReport();
  report.final_pose.reset();
  report.consistency->ok_frames = {};
  const nlohmann::json json = EvaluationToJson(report);
  EXPECT_EQ(json.at("rpe_metres").at("count"), 0);
  EXPECT_TRUE(json.at("rpe_metres").at("translation_m").is_null());
  EXPECT_TRUE(json.at("rpe_metres").at("rotation_deg").is_null());
  EXPECT_TRUE(json.at("final_pose").is_null());
  EXPECT_TRUE(json.at("consistency").at("ok_frames").at("nees").is_null());
  EXPECT_THAT(FormatEvaluation(report), HasSubstr("first\n"
                                                  "                "
                                                  "                "
                                                  "         n/a\n"));
}

TEST(EvaluationReportTest, NamesTheIntervalsInUse) {
  EvaluationReport report = MakeReport();
  report.options.rpe_delta_seconds = 0.5;
  report.options.rpe_delta_metres = 2.0;
  const std::string table = FormatEvaluation(report);
  EXPECT_THAT(table, HasSubstr("fixed delta 0.5 s ("));
  EXPECT_THAT(table, HasSubstr("fixed delta 2 m of"));
  const nlohmann::json json = EvaluationToJson(report);
  EXPECT_EQ(json.at("rpe_seconds").at("delta"), 0.5);
  EXPECT_EQ(json.at("rpe_metres").at("delta"), 2.0);
}

}  // namespace
}  // namespace rgbd_pose
