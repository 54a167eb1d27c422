#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluation/fixing_equations.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

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
