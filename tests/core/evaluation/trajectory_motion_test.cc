#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {
namespace {

Rigid3d YawedAt(double yaw, double x) {
  return Rigid3d(
      Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY())),
      {x, 0.0, 0.0});
}

// A quarter turn in 0.1 s while moving 1 m along x; then a gap.
const Trajectory kGuess = {{10.0, YawedAt(0.0, 0.0)},
                           {10.1, YawedAt(M_PI / 2, 1.0)},
                           {11.0, YawedAt(0.0, 5.0)}};

TEST(TrajectoryMotionTest, IsTheMotionFromPreviousToCurrent) {
  const auto motion = MotionAlong(kGuess, 10.0, 10.1);
  ASSERT_TRUE(motion.has_value());
  // The current camera's z axis is the world's x axis; hence the previous
  // camera is 1 m behind it.
  const Rigid3d expected = YawedAt(M_PI / 2, 1.0).Inverse();
  EXPECT_LE((motion->translation - expected.translation).norm(), 1e-12);
  EXPECT_NEAR(motion->translation.z(), -1.0, 1e-12);
  EXPECT_NEAR(motion->Angle(), M_PI / 2, 1e-12);
}

TEST(TrajectoryMotionTest, InterpolatesBetweenPoses) {
  const auto motion = MotionAlong(kGuess, 10.0, 10.05);
  ASSERT_TRUE(motion.has_value());
  EXPECT_NEAR(motion->Angle(), M_PI / 4, 1e-9);
  EXPECT_NEAR(motion->Inverse().translation.x(), 0.5, 1e-9);
}

TEST(TrajectoryMotionTest, KnowsNothingInGapsAndBeyondTheEnds) {
  EXPECT_FALSE(MotionAlong(kGuess, 10.05, 10.5).has_value());
  EXPECT_FALSE(MotionAlong(kGuess, 9.9, 10.05).has_value());
  EXPECT_FALSE(MotionAlong(kGuess, 11.0, 11.1).has_value());
  EXPECT_TRUE(MotionAlong(kGuess, 9.99, 10.05).has_value());
  EXPECT_FALSE(MotionAlong(Trajectory(), 0.0, 0.1).has_value());
}

}  // namespace
}  // namespace rgbd_pose
