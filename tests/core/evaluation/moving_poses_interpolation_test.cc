#include <gtest/gtest.h>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kPathTolerance = 1e-12;  // rounding

Rigid3d TurnedAndMoved(double angle, double distance) {
  return {Quaterniond(AngleAxisd(angle, Vector3d::UnitY())),
          Vector3d(distance, 0, 0)};
}

TEST(InterpolatedPoseTest, GoesAlongLineAndArc) {
  Rigid3d other_sign = TurnedAndMoved(0.4, 2.0);
  other_sign.rotation.coeffs() *= -1.0;
  const Trajectory truth = {{1.00, TurnedAndMoved(0.0, 1.0)},
                            {1.04, other_sign}};
  const std::optional<Rigid3d> pose = InterpolatedPose(truth, 1.01);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR((pose->Inverse() * TurnedAndMoved(0.1, 1.25)).Angle(), 0.0,
              kPathTolerance);
  EXPECT_NEAR(pose->translation.x(), 1.25, kPathTolerance);
}

TEST(InterpolatedPoseTest, CrossesNoGapsAndDoesNotLeave) {
  const Trajectory truth = {{0.0, TurnedAndMoved(0.0, 1.0)},
                            {0.06, TurnedAndMoved(0.0, 2.0)},
                            {0.08, TurnedAndMoved(0.0, 3.0)}};
  EXPECT_FALSE(InterpolatedPose(truth, -0.001).has_value());
  EXPECT_TRUE(InterpolatedPose(truth, 0.0).has_value());
  EXPECT_FALSE(InterpolatedPose(truth, 0.03).has_value());
  EXPECT_EQ(InterpolatedPose(truth, 0.06)->translation.x(), 2.0);
  EXPECT_NEAR(InterpolatedPose(truth, 0.07)->translation.x(), 2.5,
              kPathTolerance);
  EXPECT_EQ(InterpolatedPose(truth, 0.08)->translation.x(), 3.0);
  EXPECT_FALSE(InterpolatedPose(truth, 0.081).has_value());
}

}  // namespace
}  // namespace rgbd_pose
