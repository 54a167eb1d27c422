#include "core/evaluation/alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluation/evaluation.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// Alignments that positions determine are exact up to rounding and the
// influence of the first orientation (1e-9 of a radian or less).
constexpr double kTolerance = 1e-8;
// Components that only the first orientation determines: rounding (1e-16) over
// its weight (1e-9), with a margin for the size of the numbers.
constexpr double kOpenTolerance = 1e-5;

// Pairs whose estimates are `world` times the truth.
std::vector<PosePair> MakePairs(const std::vector<Vector3d>& positions,
                                const Rigid3d& world, RandomWorld* random) {
  std::vector<PosePair> pairs;
  for (const Vector3d& position : positions) {
    const Rigid3d truth(random->Motion(3.0, 0.0).rotation, position);
    pairs.push_back({0.1 * pairs.size(), truth, world * truth});
  }
  return pairs;
}

void ExpectNear(const Rigid3d& a, const Rigid3d& b, double tolerance) {
  EXPECT_LE((a * b.Inverse()).Angle(), tolerance);
  EXPECT_LE((a.translation - b.translation).norm(), 10 * tolerance);
}

TEST(AlignmentTest, FindsTheWorldOfTheEstimate) {
  RandomWorld random(2);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vector3d> positions;
    for (int i = 0; i < 3 + trial; ++i) positions.push_back(random.Vector(2.0));
    const Rigid3d world = random.Motion(3.1, 5.0);
    ExpectNear(AlignRigidly(MakePairs(positions, world, &random)),
               world.Inverse(), kTolerance);
  }
}

TEST(AlignmentTest, IgnoresOrientationsWherePositionsDecide) {
  RandomWorld random(3);
  std::vector<Vector3d> positions;
  for (int i = 0; i < 20; ++i) positions.push_back(random.Vector(2.0));
  const Rigid3d world = random.Motion(3.1, 5.0);
  std::vector<PosePair> pairs = MakePairs(positions, world, &random);
  for (PosePair& pair : pairs) {
    pair.estimate.rotation = random.Motion(3.0, 0.0).rotation;
  }
  ExpectNear(AlignRigidly(pairs), world.Inverse(), kTolerance);
}

// The mirror image x -> -x would fit, but is no rigid motion. The best rigid
// fit is the half turn about y, which is wrong only along z, the shortest axis.
TEST(AlignmentTest, NeverMirrors) {
  RandomWorld random(4);
  const std::vector<Vector3d> positions = {{3, 0, 0},  {-3, 0, 0}, {0, 2, 0},
                                           {0, -2, 0}, {0, 0, 1},  {0, 0, -1}};
  std::vector<PosePair> pairs = MakePairs(positions, Rigid3d(), &random);
  for (PosePair& pair : pairs) pair.estimate.translation.x() *= -1.0;
  const Rigid3d half_turn(Eigen::Quaterniond(0, 0, 1, 0), Vector3d::Zero());
  ExpectNear(AlignRigidly(pairs), half_turn, kTolerance);
}

TEST(AlignmentTest, TakesWhatPositionsLeaveOpenFromTheFirstOrientation) {
  const Vector3d start(0.3, -1.2, 2.0);
  const Vector3d step(0.1, 0.2, -0.05);
  const struct {
    const char* what;
    std::vector<Vector3d> positions;
  } kCases[] = {
      {"one pose", {start}},
      {"two poses", {start, start + step}},
      {"still", {start, start, start, start}},
      {"a line", {start, start + step, start + 3 * step, start + 4 * step}},
      {"there and back", {start, start + step, start, start - step}},
      {"a plane", {start, start + step, start + step.unitOrthogonal()}},
  };
  RandomWorld random(5);
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.what);
    for (int trial = 0; trial < 20; ++trial) {
      const Rigid3d world = random.Motion(3.1, 5.0);
      ExpectNear(AlignRigidly(MakePairs(c.positions, world, &random)),
                 world.Inverse(), kOpenTolerance);
    }
  }
}

TEST(AlignmentTest, PutsAnEstimateThatStandsStillOnTheMean) {
  RandomWorld random(6);
  const Rigid3d world = random.Motion(3.1, 5.0);
  std::vector<PosePair> pairs =
      MakePairs({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 4}}, world, &random);
  for (PosePair& pair : pairs) pair.estimate = pairs[0].estimate;
  const Rigid3d found = AlignRigidly(pairs);
  const Vector3d mean(0.5, 1.0, 1.0);
  EXPECT_LE((found * pairs[0].estimate.translation - mean).norm(), 1e-12);
  EXPECT_LE((found * world).Angle(), kOpenTolerance);
}

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
