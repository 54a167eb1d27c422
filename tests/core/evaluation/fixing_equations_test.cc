#include "core/evaluation/fixing_equations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(FixingParametersTest, UnitsAreThoseOfAGreatDeal) {
  FixingVector x;
  x << 1.0, 0.0, -1.0, 0.0, 2.0, 0.0, 0.5;
  const TruthFixing fixing = FixingAt(x);
  EXPECT_DOUBLE_EQ(fixing.shift, 0.02);
  EXPECT_NEAR(fixing.camera_from_body.Angle(), 2.0 * kRadiansPerDegree, 1e-12);
  EXPECT_LT(fixing.camera_from_body.rotation.y(), 0.0);
  EXPECT_EQ(fixing.camera_from_body.translation, Vector3d(0.1, 0.0, 0.025));
}

TEST(FixingParametersTest, NamesDirections) {
  const FixingMatrix all = FixingMatrix::Identity();
  EXPECT_THAT(NameFixingDirections(all.leftCols(0)), IsEmpty());
  EXPECT_THAT(NameFixingDirections(all),
              ElementsAre("time shift", "rotation", "lever"));
  EXPECT_THAT(NameFixingDirections(-all.middleCols(2, 1)),
              ElementsAre("rotation about (0.00, 1.00, 0.00)"));
  FixingVector mixed = FixingVector::Zero();
  mixed[0] = mixed[5] = std::sqrt(0.5);
  EXPECT_THAT(NameFixingDirections(mixed),
              ElementsAre("time shift", "lever along (0.00, 1.00, 0.00)"));
}

// Error of central differences over 1 ms, with third derivatives of about 1.
constexpr double kRateTolerance = 1e-5;

Rigid3d Wave(double t) {
  const Twist turn{{std::sin(t), 0.5 * std::cos(2.0 * t), 0.3 * t},
                   Vector3d::Zero()};
  return {turn.MotionDuring(-1.0).rotation,
          Vector3d(std::cos(t), std::sin(1.5 * t), t)};
}

MovingPose MovingAt(double t) {
  constexpr double kStep = 1e-3;
  return *MovingPoses({t - kStep, t, t + kStep},
                      {Wave(t - kStep), Wave(t), Wave(t + kStep)})[1];
}

// To first order, the rotations before and after differ by the rotation rate
// times the time between them.
TEST(MovingPosesTest, RateIsHowTheMotionChanges) {
  constexpr double kStep = 1e-3;
  const PoseChange before(MovingAt(1.0 - kStep), MovingAt(1.2 - kStep));
  const PoseChange at(MovingAt(1.0), MovingAt(1.2));
  const PoseChange after(MovingAt(1.0 + kStep), MovingAt(1.2 + kStep));
  const Vector3d rate =
      (after.translation - before.translation) / (2.0 * kStep);
  EXPECT_LT((rate - at.rate.linear).norm(), kRateTolerance);
  const Eigen::Quaterniond turn(after.rotation * before.rotation.transpose());
  const Vector3d turn_rate =
      -TwistOf(Rigid3d(turn, Vector3d::Zero()), 2.0 * kStep).angular;
  EXPECT_LT((turn_rate - at.rate.angular).norm(), kRateTolerance);
}

TEST(MovingPosesTest, NoVelocityWithoutNeighbours) {
  const std::vector<double> times = {0.0, 0.1, 0.2, 0.3, 0.6, 0.7};
  std::vector<std::optional<Rigid3d>> poses;
  for (const double t : times) poses.emplace_back(Wave(t));
  const auto moving = MovingPoses(times, poses);
  EXPECT_FALSE(moving[0].has_value());
  EXPECT_TRUE(moving[1].has_value());
  EXPECT_FALSE(moving[3].has_value());  // gap of 0.4 s, from 0.2 to 0.6
  EXPECT_FALSE(moving[5].has_value());
  poses[1].reset();
  for (const auto& pose : MovingPoses(times, poses)) {
    EXPECT_FALSE(pose.has_value());
  }
}

}  // namespace
}  // namespace rgbd_pose
