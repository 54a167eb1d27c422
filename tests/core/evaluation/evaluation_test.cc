#include "core/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Rounding of numbers up to about 10 (some 1e-16), through products of a few
// rotations.
constexpr double kErrorTolerance = 1e-12;

// Poses without rotation at the given positions, 0.1 s apart.
Trajectory Unturned(const std::vector<Vector3d>& positions) {
  Trajectory trajectory;
  for (const Vector3d& position : positions) {
    trajectory.push_back(
        {0.1 * trajectory.size(), {Quaterniond::Identity(), position}});
  }
  return trajectory;
}

// A pose translated along z and rotated about z.
Rigid3d Screw(double angle, double distance) {
  return {Quaterniond(AngleAxisd(angle, Vector3d::UnitZ())),
          Vector3d(0, 0, distance)};
}

// A random walk in all six degrees of freedom.
Trajectory Walk(unsigned seed, int count) {
  RandomWorld random(seed);
  Trajectory trajectory = {{10.0, Rigid3d()}};
  while (static_cast<int>(trajectory.size()) < count) {
    trajectory.push_back(
        {10.0 + trajectory.size() / 30.0,
         trajectory.back().world_from_cam * random.Motion(0.05, 0.05)});
  }
  return trajectory;
}

TEST(EvaluationTest, FindsNoErrorInTheTruth) {
  const Trajectory truth = Walk(1, 200);
  const EvaluationReport report = Evaluate(truth, truth);
  EXPECT_EQ(report.estimated_poses, 200);
  EXPECT_EQ(report.paired_poses, 200);
  EXPECT_NEAR(report.duration, 199 / 30.0, kErrorTolerance);
  EXPECT_EQ(report.ate.count, 200);
  EXPECT_EQ(report.rpe_frame.translation.count, 199);
  EXPECT_EQ(report.rpe_seconds.translation.count, 170);
  EXPECT_GT(report.rpe_metres.translation.count, 100);
  EXPECT_LE(report.ate.max, kErrorTolerance);
  for (const RelativePoseError& rpe :
       {report.rpe_frame, report.rpe_seconds, report.rpe_metres}) {
    EXPECT_LE(rpe.translation.max, kErrorTolerance);
    EXPECT_LE(rpe.rotation.max, kErrorTolerance);
  }
}

// Without alignment, poses are compared in one common world.
TEST(EvaluationTest, WithoutAlignmentAShiftIsAnError) {
  const Trajectory truth = Walk(1, 20);
  Trajectory shifted = truth;
  for (StampedPose& pose : shifted) pose.world_from_cam.translation.x() += 0.25;
  EvaluationOptions options;
  EXPECT_NEAR(Evaluate(shifted, truth, options).ate.max, 0.0, kErrorTolerance);
  options.align = false;
  const EvaluationReport report = Evaluate(shifted, truth, options);
  EXPECT_NEAR(report.ate.rmse, 0.25, kErrorTolerance);
  EXPECT_LE(report.sim3.residual_rmse, kErrorTolerance);
}

// Positions 0, 1, 2, 3, 4 m estimated as 0, 1.1, 2.2, 3.3, 4.4 m are wrong by
// 0.2, 0.1, 0, 0.1, 0.2 m with equal means. Without scale, no alignment is
// better.
TEST(EvaluationTest, AteOfAWrongScaleOnALine) {
  std::vector<Vector3d> truth, estimate;
  for (int i = 0; i < 5; ++i) {
    truth.emplace_back(i, 0, 0);
    estimate.emplace_back(7.0, 1.1 * i, 0);
  }
  const ErrorStatistics ate = Evaluate(Unturned(estimate), Unturned(truth)).ate;
  EXPECT_EQ(ate.count, 5);
  EXPECT_NEAR(ate.rmse, 0.1 * std::sqrt(2.0), kErrorTolerance);
  EXPECT_NEAR(ate.mean, 0.12, kErrorTolerance);
  EXPECT_NEAR(ate.median, 0.1, kErrorTolerance);
  EXPECT_NEAR(ate.max, 0.2, kErrorTolerance);
}

// A square whose corners are bent up and down in turn: no rotation helps.
TEST(EvaluationTest, AteOfABentSquare) {
  const Trajectory truth =
      Unturned({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}});
  const Trajectory estimate =
      Unturned({{1, 1, .1}, {-1, 1, -.1}, {-1, -1, .1}, {1, -1, -.1}});
  const ErrorStatistics ate = Evaluate(estimate, truth).ate;
  EXPECT_NEAR(ate.rmse, 0.1, kErrorTolerance);
  EXPECT_NEAR(ate.median, 0.1, kErrorTolerance);
  EXPECT_NEAR(ate.max, 0.1, kErrorTolerance);
}

// The error of a static estimate is the spread of the truth.
TEST(EvaluationTest, AteOfAnEstimateThatStandsStill) {
  const Trajectory truth =
      Unturned({{0, 0, 0}, {2, 0, 0}, {0, 0, 0}, {2, 0, 0}});
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate) pose.world_from_cam = Screw(0.5, 3.0);
  EXPECT_NEAR(Evaluate(estimate, truth).ate.rmse, 1.0, kErrorTolerance);
}

// Steps of 1, 2 and 3 m, while the truth is static.
TEST(EvaluationTest, RpeByHand) {
  const Trajectory truth = Unturned(std::vector<Vector3d>(4, {5, 5, 5}));
  const Trajectory estimate =
      Unturned({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, 2, 3}});
  EvaluationOptions options;
  options.rpe_delta_seconds = 0.2;
  const EvaluationReport report = Evaluate(estimate, truth, options);
  const ErrorStatistics frame = report.rpe_frame.translation;
  EXPECT_EQ(frame.count, 3);
  EXPECT_NEAR(frame.rmse, std::sqrt((1.0 + 4.0 + 9.0) / 3.0), kErrorTolerance);
  EXPECT_NEAR(frame.mean, 2.0, kErrorTolerance);
  EXPECT_NEAR(frame.median, 2.0, kErrorTolerance);
  EXPECT_NEAR(frame.max, 3.0, kErrorTolerance);
  EXPECT_EQ(report.rpe_frame.rotation.count, 3);
  EXPECT_LE(report.rpe_frame.rotation.max, kErrorTolerance);
  const ErrorStatistics seconds = report.rpe_seconds.translation;
  EXPECT_EQ(seconds.count, 2);
  EXPECT_NEAR(seconds.rmse, std::sqrt((5.0 + 13.0) / 2.0), kErrorTolerance);
  EXPECT_NEAR(seconds.median, (std::sqrt(5.0) + std::sqrt(13.0)) / 2.0,
              kErrorTolerance);
  // The truth has no path along which metres could be counted.
  EXPECT_EQ(report.path_length, 0.0);
  EXPECT_EQ(report.rpe_metres.translation.count, 0);
  EXPECT_EQ(report.rpe_metres.translation.rmse, 0.0);
}

// The statistics summarise the errors of the single poses.
TEST(EvaluationTest, PosesHaveErrorsOfTheirOwn) {
  const EvaluationReport report = Evaluate(Walk(2, 100), Walk(3, 100));
  ASSERT_EQ(report.poses.size(), 100u);
  double largest = 0.0;
  double largest_turn = 0.0;
  int intervals = 0;
  for (const PoseError& pose : report.poses) {
    largest = std::max(largest, pose.position);
    ASSERT_EQ(pose.rpe_translation.has_value(), pose.rpe_rotation.has_value());
    if (!pose.rpe_rotation.has_value()) continue;
    ++intervals;
    largest_turn = std::max(largest_turn, *pose.rpe_rotation);
  }
  EXPECT_EQ(largest, report.ate.max);
  EXPECT_EQ(largest_turn, report.rpe_seconds.rotation.max);
  EXPECT_EQ(intervals, 70);  // 1 s each, at 30 Hz
  EXPECT_TRUE(report.poses[69].rpe_translation.has_value());
}

// The truth moves along z at 0.5 m/s; the estimate gains 0.03 m and 0.02 rad of
// yaw per second. Hence every error is the drift times its interval.
TEST(EvaluationTest, RpeOfAConstantDrift) {
  constexpr double kSpeed = 0.5, kDrift = 0.03, kYawDrift = 0.02;
  Trajectory truth, estimate;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    truth.push_back({t, Screw(0.0, kSpeed * t)});
    estimate.push_back({t, Screw(kYawDrift * t, (kSpeed + kDrift) * t)});
  }
  const EvaluationReport report = Evaluate(estimate, truth);
  const struct {
    const char* what;
    const RelativePoseError& rpe;
    double interval;  // s
    int count;
  } kCases[] = {{"frame", report.rpe_frame, 0.1, 100},
                {"second", report.rpe_seconds, 1.0, 91},
                {"metre", report.rpe_metres, 1.0 / kSpeed, 81}};
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.what);
    EXPECT_EQ(c.rpe.translation.count, c.count);
    EXPECT_EQ(c.rpe.rotation.count, c.count);
    for (double (*figure)(const ErrorStatistics&) :
         {+[](const ErrorStatistics& e) { return e.rmse; },
          +[](const ErrorStatistics& e) { return e.mean; },
          +[](const ErrorStatistics& e) { return e.median; },
          +[](const ErrorStatistics& e) { return e.max; }}) {
      EXPECT_NEAR(figure(c.rpe.translation), kDrift * c.interval,
                  kErrorTolerance);
      EXPECT_NEAR(figure(c.rpe.rotation), kYawDrift * c.interval,
                  kErrorTolerance);
    }
  }
  ASSERT_TRUE(report.final_pose.has_value());
  EXPECT_NEAR(report.final_pose->translation, kDrift * 10.0, kErrorTolerance);
  EXPECT_NEAR(report.final_pose->angle, kYawDrift * 10.0, kErrorTolerance);
  EXPECT_NEAR(report.path_length, kSpeed * 10.0, kErrorTolerance);
}

// A wrong rotation at the end of the motion is no position error.
TEST(EvaluationTest, RpeKeepsTurnsAndPlacesApart) {
  const Rigid3d step(Quaterniond::Identity(), {1, 0, 0});
  const Rigid3d turn(Quaterniond(AngleAxisd(0.3, Vector3d::UnitY())),
                     {0, 0, 0});
  const RelativePoseError rpe =
      Evaluate({{0, Rigid3d()}, {1, step * turn}}, {{0, Rigid3d()}, {1, step}})
          .rpe_frame;
  EXPECT_LE(rpe.translation.rmse, kErrorTolerance);
  EXPECT_NEAR(rpe.rotation.rmse, 0.3, kErrorTolerance);
}

// From 0 s, the pose at 1.01 s is near enough to 1 s. From 0.5 s on, there is
// no pose near enough.
TEST(EvaluationTest, SecondsAreNotCountedAcrossGaps) {
  Trajectory truth;
  for (const double t : {0.0, 0.5, 1.01, 1.6}) truth.push_back({t, Rigid3d()});
  EXPECT_EQ(Evaluate(truth, truth).rpe_seconds.translation.count, 1);
}

// Steps of 0.1 m: 1 m is reached after ten steps, only from the first pose.
TEST(EvaluationTest, MetresEndAtTheFirstPoseFarEnough) {
  std::vector<Vector3d> positions, scaled;
  for (int i = 0; i <= 10; ++i) {
    positions.emplace_back(0.1 * i, 0, 0);
    scaled.emplace_back(0.12 * i, 0, 0);
  }
  const Trajectory truth = Unturned(positions);
  const Trajectory estimate = Unturned(scaled);
  const ErrorStatistics metre =
      Evaluate(estimate, truth).rpe_metres.translation;
  EXPECT_EQ(metre.count, 1);
  EXPECT_NEAR(metre.rmse, 0.2, kErrorTolerance);
  EvaluationOptions options;
  options.rpe_delta_metres = 0.25;  // three steps
  const ErrorStatistics quarter =
      Evaluate(estimate, truth, options).rpe_metres.translation;
  EXPECT_EQ(quarter.count, 8);
  EXPECT_NEAR(quarter.max, 0.06, kErrorTolerance);
}

void ExpectSame(const ErrorStatistics& a, const ErrorStatistics& b) {
  constexpr double kSameTolerance = 1e-10;  // positions of 100 m
  EXPECT_EQ(a.count, b.count);
  EXPECT_GT(a.rmse, 1e-3);  // the errors compared must not be zero
  EXPECT_NEAR(a.rmse, b.rmse, kSameTolerance);
  EXPECT_NEAR(a.mean, b.mean, kSameTolerance);
  EXPECT_NEAR(a.median, b.median, kSameTolerance);
  EXPECT_NEAR(a.max, b.max, kSameTolerance);
}

TEST(EvaluationTest, TheWorldOfTheEstimateDoesNotMatter) {
  const Trajectory truth = Walk(1, 300);
  Trajectory estimate = truth;
  RandomWorld random(2);
  for (StampedPose& pose : estimate) {
    pose.world_from_cam = pose.world_from_cam * random.Motion(0.02, 0.02);
  }
  const EvaluationReport report = Evaluate(estimate, truth);
  for (int trial = 0; trial < 10; ++trial) {
    const Rigid3d world = random.Motion(3.1, 100.0);
    Trajectory moved = estimate;
    for (StampedPose& pose : moved) {
      pose.world_from_cam = world * pose.world_from_cam;
    }
    const EvaluationReport other = Evaluate(moved, truth);
    ExpectSame(report.ate, other.ate);
    ExpectSame(report.rpe_frame.translation, other.rpe_frame.translation);
    ExpectSame(report.rpe_frame.rotation, other.rpe_frame.rotation);
    ExpectSame(report.rpe_seconds.translation, other.rpe_seconds.translation);
    ExpectSame(report.rpe_seconds.rotation, other.rpe_seconds.rotation);
    ExpectSame(report.rpe_metres.translation, other.rpe_metres.translation);
    ExpectSame(report.rpe_metres.rotation, other.rpe_metres.rotation);
    EXPECT_NEAR(report.final_pose->translation, other.final_pose->translation,
                1e-10);
    EXPECT_NEAR(report.final_pose->angle, other.final_pose->angle, 1e-10);
  }
}

// Seen from its own start, the estimate ends 3, 4 and 12 cm and 0.1 rad away
// from the true final pose.
TEST(EvaluationTest, FinalPoseIsJudgedFromTheFirst) {
  RandomWorld random(3);
  const Rigid3d start = random.Motion(2.0, 5.0);
  const Rigid3d world = random.Motion(2.0, 5.0);
  const Rigid3d way = random.Motion(2.0, 5.0);
  const Rigid3d error(Quaterniond(AngleAxisd(0.1, Vector3d::UnitX())),
                      Vector3d(0.03, 0.04, 0.12));
  const EvaluationReport report =
      Evaluate({{0, world}, {1, world * Screw(3, 2)}, {2, world * way * error}},
               {{0, start}, {1, start}, {2, start * way}});
  ASSERT_TRUE(report.final_pose.has_value());
  EXPECT_NEAR(report.final_pose->translation, 0.13, kErrorTolerance);
  EXPECT_NEAR(report.final_pose->angle, 0.1, kErrorTolerance);
}

TEST(EvaluationTest, JudgesASinglePose) {
  const EvaluationReport report =
      Evaluate({{1.0, Screw(1, 2)}, {9.0, Screw(0, 0)}}, {{1.01, Rigid3d()}});
  EXPECT_EQ(report.estimated_poses, 2);
  EXPECT_EQ(report.paired_poses, 1);
  EXPECT_EQ(report.duration, 0.0);
  EXPECT_EQ(report.ate.count, 1);
  EXPECT_LE(report.ate.rmse, kErrorTolerance);
  EXPECT_EQ(report.rpe_frame.translation.count, 0);
  EXPECT_EQ(report.rpe_seconds.translation.count, 0);
  EXPECT_EQ(report.rpe_metres.translation.count, 0);
  EXPECT_FALSE(report.final_pose.has_value());
}

TEST(EvaluationTest, RefusesWhatCannotBeJudged) {
  const Trajectory a = {{1.0, Rigid3d()}};
  const Trajectory b = {{1.5, Rigid3d()}};
  ExpectInputError([&] { Evaluate(a, b); }, {"1.500000 s"});
  const double nan = std::nan("");
  const EvaluationOptions kBadOptions[] = {
      {-0.1, 1, 1},   {nan, 1, 1},  {INFINITY, 1, 1}, {0.02, 0.02, 1},
      {0.02, nan, 1}, {0.02, 1, 0}, {0.02, 1, nan}};
  for (const EvaluationOptions& options : kBadOptions) {
    EXPECT_NE(options.Check(), "");
    ExpectInputError([&] { Evaluate(a, a, options); }, {options.Check()});
  }
  EXPECT_EQ(EvaluationOptions().Check(), "");
}

}  // namespace
}  // namespace rgbd_pose
