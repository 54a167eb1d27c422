#include "apps/compare/compare_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

Rigid3d At(double x, double turn = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitX())),
          Eigen::Vector3d(x, 0.0, 0.0)};
}

// Ten frames a second along the x axis in the run's own world. The path is
// `scale` times as long as the true one; frame 1 is lost.
LossRun MakeRun(const std::string& loss, int frames, double scale) {
  LossRun run;
  run.loss = loss;
  for (int i = 0; i < frames; ++i) {
    TrackedFrame frame;
    frame.index = i;
    frame.timestamp = 0.1 * i;
    frame.status = i == 1 ? TrackingStatus::kLost : TrackingStatus::kOk;
    frame.world_from_cam = At(scale * i);
    run.frames.push_back(frame);
    if (i == 1) continue;
    run.trajectory.push_back({frame.timestamp, frame.world_from_cam});
  }
  return run;
}

// The true path, in a rotated world in which frame 0 is at x = 5.
Trajectory Truth(int frames) {
  Trajectory truth;
  for (int i = 0; i < frames; ++i) {
    truth.push_back({0.1 * i + 0.004, At(5.0 + i, 0.3)});
  }
  return truth;
}

TEST(ComparePathsTest, PathsStartAtThePoseOfTheTruth) {
  const Trajectory truth = Truth(4);
  std::vector<LossRun> runs = {MakeRun("none", 4, 1.5)};
  runs[0].evaluation = Evaluate(runs[0].trajectory, truth);
  const std::vector<ComparedPath> paths = ComparePaths(runs, truth);
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_EQ(paths[0].name, kTruthName);
  EXPECT_EQ(paths[0].poses[1].world_from_cam->translation.x(), 6.0);
  const std::vector<ComparedPose>& poses = paths[1].poses;
  ASSERT_EQ(poses.size(), 4u);
  EXPECT_NEAR(*poses[0].distance, 0.0, 1e-12);
  EXPECT_FALSE(poses[1].world_from_cam.has_value()) << "it was lost";
  EXPECT_FALSE(poses[1].distance.has_value());
  EXPECT_NEAR(poses[3].world_from_cam->translation.x(), 5.0 + 4.5, 1e-12);
  EXPECT_NEAR(*poses[3].distance, 1.5, 1e-12);
  EXPECT_NEAR(*poses[3].angle, 0.0, 1e-12);
  EXPECT_FALSE(poses[3].rpe_translation.has_value()) << "shorter than 1 s";
}

TEST(ComparePathsTest, MotionsOverOneSecondAreThoseOfTheirFrame) {
  const Trajectory truth = Truth(13);
  std::vector<LossRun> runs = {MakeRun("none", 13, 1.5)};
  runs[0].evaluation = Evaluate(runs[0].trajectory, truth);
  const std::vector<ComparedPath> paths = ComparePaths(runs, truth);
  EXPECT_NEAR(*paths[1].poses[2].rpe_translation, 5.0, 1e-9);
  EXPECT_FALSE(paths[1].poses[1].rpe_translation.has_value());
}

TEST(ComparePathsTest, WithoutTruthTheWorldIsThatOfTheRuns) {
  const std::vector<ComparedPath> paths =
      ComparePaths({MakeRun("none", 3, 2.0)}, std::nullopt);
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_EQ(paths[0].poses[2].world_from_cam->translation.x(), 4.0);
  EXPECT_FALSE(paths[0].poses[2].distance.has_value());
}

TEST(ComparePathsTest, RowsLeaveUnknownCellsEmpty) {
  const std::string rows = ComparedPathsCsvRows(
      "a, b", ComparePaths({MakeRun("none", 2, 2.0)}, std::nullopt));
  EXPECT_EQ(rows,
            "\"a, b\",none,0.000000,0.000000,0.000000,0.000000,0.000000,"
            "0.000000,0.000000,1.000000,,,,\n"
            "\"a, b\",none,0.100000,,,,,,,,,,,\n");
}

TEST(CompareTablesTest, WhatIsNotKnownIsNotZero) {
  LossRun lost = MakeRun("none", 3, 1.0);
  lost.trajectory.clear();
  LossRun brief = MakeRun("tukey", 3, 1.0);
  brief.evaluation = Evaluate(brief.trajectory, Truth(3));
  const std::vector<LossRun> runs = {lost, brief};
  const std::string errors = PathErrorTable(runs);
  EXPECT_THAT(errors,
              HasSubstr("| none | n/a | n/a | n/a | n/a | n/a | 0.0 |\n"));
  EXPECT_THAT(errors, HasSubstr("| tukey | 0.000 | n/a | n/a | 0.000 |"));
  EXPECT_THAT(EndPoseTable(runs, false),
              HasSubstr("| none | n/a | n/a | n/a | n/a |"));
  EXPECT_THAT(SequenceCsvRows("s", runs),
              HasSubstr("\"s\",none,,,,,,,,,,,,0\n"));
}

}  // namespace
}  // namespace rgbd_pose
