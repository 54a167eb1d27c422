#include "core/geometry/twist.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/util/vector_lanes.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/exact_twist.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

constexpr double kTwistRounding = 1e-12;

// Typical speeds of a handheld camera.
Twist RandomTwist(RandomWorld* world) {
  const Vector3d angular = world->Vector(1.5);
  return {angular, world->Vector(1.0)};
}

constexpr int kSteps = 2000;  // of exact motions

TEST(TwistTest, MotionAndTwistAreInverse) {
  RandomWorld world(1);
  for (int i = 0; i < 100; ++i) {
    const Twist twist = RandomTwist(&world);
    for (const double seconds : {0.033, -0.02, 1.0}) {
      const Twist back = TwistOf(twist.MotionDuring(seconds), seconds);
      EXPECT_LT((back - twist).angular.norm(), 1e-11);
      EXPECT_LT((back - twist).linear.norm(), kTwistRounding);
    }
  }
}

// For a camera that moves forward, points come nearer; for a camera that turns
// to the right, points move to the left.
TEST(TwistTest, PointsMoveAgainstTheCamera) {
  const Twist forward = {Vector3d::Zero(), {0.0, 0.0, 2.0}};
  EXPECT_LT((forward.MotionDuring(0.25) * Vector3d(0.0, 0.0, 3.0) -
             Vector3d(0.0, 0.0, 2.5))
                .norm(),
            kTwistRounding);
  const Twist right = {{0.0, M_PI, 0.0}, Vector3d::Zero()};
  EXPECT_LT((right.MotionDuring(0.5) * Vector3d(0.0, 0.0, 3.0) -
             Vector3d(-3.0, 0.0, 0.0))
                .norm(),
            kTwistRounding);
}

TEST(TwistTest, NoMotionIsNoTwist) {
  const Twist none = TwistOf(Rigid3d(), 0.03);
  EXPECT_EQ(none.angular, Vector3d::Zero());
  EXPECT_EQ(none.linear, Vector3d::Zero());
  EXPECT_EQ(none.MotionDuring(0.03).Angle(), 0.0);
}

// q and -q are the same rotation.
TEST(TwistTest, TheShorterWayRound) {
  Rigid3d motion = Twist{{0.1, -0.2, 0.3}, Vector3d::Zero()}.MotionDuring(1.0);
  motion.rotation.coeffs() = -motion.rotation.coeffs();
  EXPECT_LT((TwistOf(motion, 1.0).angular - Vector3d(0.1, -0.2, 0.3)).norm(),
            kTwistRounding);
}

TEST(TwistTest, WeightedSums) {
  const Twist a = {
      {1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}, {7.0, 8.0, 9.0}, {1.0, 3.0, 5.0}};
  const Twist b = {
      {0.5, 0.0, -1.0}, {2.0, 1.0, 0.0}, {3.0, 2.0, 1.0}, {0.0, -1.0, 1.0}};
  const Twist sum = 2.0 * a + b - a;
  EXPECT_EQ(sum.angular, Vector3d(1.5, 2.0, 2.0));
  EXPECT_EQ(sum.linear, Vector3d(6.0, 6.0, 6.0));
  EXPECT_EQ(sum.angular_acceleration, Vector3d(10.0, 10.0, 10.0));
  EXPECT_EQ(sum.linear_acceleration, Vector3d(1.0, 2.0, 6.0));
}

// As far as a hand accelerates, in the time in which rows are exposed.
TEST(TwistTest, PointsMoveWithAccelerations) {
  RandomWorld world(4);
  for (int i = 0; i < 20; ++i) {
    Twist twist = RandomTwist(&world);
    twist.angular_acceleration = world.Vector(20.0);
    twist.linear_acceleration = world.Vector(8.0);
    Twist constant = twist;
    constant.angular_acceleration.setZero();
    constant.linear_acceleration.setZero();
    const Vector3d point = world.Vector(1.0) + Vector3d(0.0, 0.0, 2.0);
    for (const double seconds : {0.03, -0.03}) {
      const Rigid3d motion = ExactMotion(twist, seconds, kSteps);
      const double error =
          (twist.MovedPoint(point, seconds) - motion * point).norm();
      EXPECT_LT(error, 1.5e-3) << i;
      EXPECT_LT(
          error,
          0.2 * (constant.MovedPoint(point, seconds) - motion * point).norm())
          << i;
      EXPECT_LT((twist.MovedBack(motion * point, seconds) - point).norm(),
                1.5e-3)
          << i;
      EXPECT_LT((twist.MotionBack(seconds) * (motion * point) - point).norm(),
                3e-3)
          << i;
    }
  }
}

TEST(TwistTest, PointsMoveToSecondOrder) {
  RandomWorld world(2);
  for (int i = 0; i < 20; ++i) {
    const Twist twist = RandomTwist(&world);
    const Vector3d point = world.Vector(1.0) + Vector3d(0.0, 0.0, 2.0);
    const auto error = [&](double seconds) {
      return (twist.MovedPoint(point, seconds) -
              ExactMotion(twist, seconds, kSteps) * point)
          .norm();
    };
    for (const double seconds : {0.04, -0.04}) {
      // Third-order terms, plus the second-order terms of each short motion.
      const double turn = twist.angular.norm() * std::abs(seconds);
      const double shift = twist.linear.norm() * std::abs(seconds);
      const double third = turn * turn * (turn * point.norm() + shift) / 6.0;
      EXPECT_LT(error(seconds), 1.1 * third + turn * shift / 2000) << i;
    }
    EXPECT_EQ(twist.MovedPoint(point, 0.0), point);
  }
}

// Without translation, MotionDuring() is exact as well.
TEST(TwistTest, PointsMoveAsTheyAreTurned) {
  const Twist twist = {{0.8, -1.2, 0.5}, Vector3d::Zero()};
  const Vector3d point(0.4, -0.3, 2.0);
  const auto error = [&](double seconds) {
    return (twist.MovedPoint(point, seconds) -
            twist.MotionDuring(seconds) * point)
        .norm();
  };
  EXPECT_LT(error(0.02), 1e-5);
  EXPECT_NEAR(error(0.04) / error(0.02), 8.0, 0.2);
}

TEST(TwistTest, VectorsOfDoublesAgreeWithScalars) {
  using Four = Lanes<4>::Type;
  RandomWorld world(3);
  const Twist twist = RandomTwist(&world);
  Vector3d points[4];
  Four point[3], moved[3], seconds;
  for (int lane = 0; lane < 4; ++lane) {
    points[lane] = world.Vector(2.0);
    seconds[lane] = 0.01 * (lane - 2);
    for (int k = 0; k < 3; ++k) point[k][lane] = points[lane][k];
  }
  twist.MovePoint(point, seconds, moved);
  for (int lane = 0; lane < 4; ++lane) {
    const Vector3d expected = twist.MovedPoint(points[lane], seconds[lane]);
    for (int k = 0; k < 3; ++k) {
      // Compilers may fuse a product and a sum in one of the two.
      EXPECT_NEAR(moved[k][lane], expected[k], kTwistRounding);
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
