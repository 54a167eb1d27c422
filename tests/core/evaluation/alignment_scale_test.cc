#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluation/alignment.h"
#include "core/evaluation/evaluation.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

// Evaluates a path of some metres against the same path in another world,
// scaled by `scale` and with errors of `error` (m).
EvaluationReport Judge(double scale, double error, double spread = 1.0) {
  const Rigid3d other(Eigen::Quaterniond(Eigen::AngleAxisd(
                          0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized())),
                      {3.0, -1.0, 2.0});
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.05 * i;
    const Eigen::Vector3d place =
        spread * Eigen::Vector3d(std::sin(t), std::cos(0.7 * t), 0.3 * t);
    const Eigen::Vector3d noise =
        error * Eigen::Vector3d(std::sin(37.0 * i), std::cos(53.0 * i),
                                std::sin(71.0 * i));
    truth.push_back({t, {Eigen::Quaterniond::Identity(), place}});
    estimate.push_back({t, other * Rigid3d(Eigen::Quaterniond::Identity(),
                                           scale * place + noise)});
  }
  return Evaluate(estimate, truth);
}

std::string WarningOf(const EvaluationReport& report) {
  return Sim3Warning(report.sim3, report.ate.rmse);
}

TEST(Sim3AlignmentTest, FindsTheScale) {
  const EvaluationReport exact = Judge(1.0, 0.0);
  EXPECT_NEAR(exact.sim3.truth_per_estimate, 1.0, 1e-9);
  EXPECT_NEAR(exact.sim3.residual_rmse, 0.0, 1e-6);
  EXPECT_EQ(WarningOf(exact), "");
  const EvaluationReport fifth = Judge(5.0, 0.01);
  EXPECT_NEAR(fifth.sim3.truth_per_estimate, 0.2, 0.001);
  EXPECT_NEAR(fifth.sim3.residual_rmse, 0.2 * 0.01 * std::sqrt(1.5), 0.001);
  EXPECT_THAT(WarningOf(fifth), HasSubstr("scaled by 0.2"));
  EXPECT_THAT(WarningOf(fifth), HasSubstr("depth scale (5 times"));
}

TEST(Sim3AlignmentTest, WarnsFromTenPercentOn) {
  EXPECT_EQ(WarningOf(Judge(1.08, 0.01)), "");
  EXPECT_EQ(WarningOf(Judge(0.93, 0.01)), "");
  EXPECT_NE(WarningOf(Judge(1.13, 0.01)), "");
  EXPECT_NE(WarningOf(Judge(0.88, 0.01)), "");
}

TEST(Sim3AlignmentTest, WarnsOfAnotherPath) {
  EXPECT_THAT(WarningOf(Judge(0.02, 1.5)), HasSubstr("does not match"));
  // A poor estimate of the same path gives no warning.
  EXPECT_EQ(WarningOf(Judge(1.0, 0.2)), "");
  // Neither does a camera that hardly moves: its path is too short to compare.
  EXPECT_EQ(WarningOf(Judge(1.0, 0.05, 0.01)), "");
}

TEST(Sim3AlignmentTest, OfAnEstimateThatStandsStill) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 10; ++i) {
    truth.push_back(
        {1.0 * i, {Eigen::Quaterniond::Identity(), {0.1 * i, 0.0, 0.0}}});
    estimate.push_back({1.0 * i, {}});
  }
  const EvaluationReport report = Evaluate(estimate, truth);
  EXPECT_EQ(report.sim3.truth_per_estimate, 1.0);
  EXPECT_THAT(WarningOf(report), HasSubstr("does not match"));
}

}  // namespace
}  // namespace rgbd_pose
