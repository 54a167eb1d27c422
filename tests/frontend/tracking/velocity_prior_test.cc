#include "frontend/tracking/velocity_prior.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_pose {
namespace {

constexpr double kInterval = 1.0 / 30.0;
constexpr double kTwistRounding = 1e-12;  // rounding

const Twist kPriorTwist = {{0.3, -0.5, 0.2}, {-0.4, 0.1, 0.6}};
const Rigid3d kPrevFromRef(Eigen::Quaterniond(Eigen::AngleAxisd(
                               0.2, Eigen::Vector3d(1, 2, -1).normalized())),
                           {0.1, -0.3, 0.2});

void ExpectNear(const Twist& a, const Twist& b,
                double tolerance = kTwistRounding) {
  EXPECT_LT((a.angular - b.angular).norm(), tolerance);
  EXPECT_LT((a.linear - b.linear).norm(), tolerance);
}

TEST(VelocityPriorTest, BetweenIsTheVelocityFromFrameToFrame) {
  const VelocityPrior prior =
      VelocityModel().Prior(kPrevFromRef, kInterval, 0.0);
  ExpectNear(*prior.Between(kPriorTwist.MotionDuring(kInterval) * kPrevFromRef,
                            Twist()),
             kPriorTwist);
}

// The velocity used for a correction does not change where points were seen.
TEST(VelocityPriorTest, MotionsAreToldByTheMiddleRow) {
  constexpr double kMiddle = -0.008;
  const Twist wrong = {{-1.0, 0.3, 0.6}, {0.5, 0.5, -0.5}};
  const Twist wrong_before = {{0.2, -0.7, 0.1}, {0.3, -0.1, 0.4}};
  VelocityModel model;
  model.Add(wrong_before, 0.0, kMiddle);
  const Rigid3d middle_from_ref = kPriorTwist.MotionDuring(kInterval) *
                                  wrong_before.MotionDuring(kMiddle) *
                                  kPrevFromRef;
  const Rigid3d cur_from_ref =
      wrong.MotionDuring(kMiddle).Inverse() * middle_from_ref;
  const VelocityPrior prior = model.Prior(kPrevFromRef, kInterval, kMiddle);
  ExpectNear(*prior.Between(cur_from_ref, wrong), kPriorTwist);
}

// A sudden turn is not in the history, but a gyroscope shows it.
TEST(VelocityPriorTest, AMeasuredTurnIsBelieved) {
  VelocityPrior prior = VelocityModel().Prior(kPrevFromRef, kInterval, 0.0);
  prior.sigma_angular = prior.sigma_linear = 0.02;
  const Twist expected;
  ExpectNear(prior.Fused(expected), expected);
  EXPECT_EQ(prior.SigmaLinear(), 0.02);
  const Twist seen = {
      {0.0, 5.0, 0.0}, {0.3, 0.0, 0.0}, {0.0, 50.0, 0.0}, {1.0, 0.0, 0.0}};
  prior.measured = MeasuredTwist{seen, 0.5};
  EXPECT_EQ(prior.Fused(expected).angular, seen.angular);
  EXPECT_EQ(prior.Fused(expected).angular_acceleration,
            seen.angular_acceleration);
  EXPECT_EQ(prior.Fused(expected).linear, expected.linear);
  // What history says of a change does not make a measured turn more certain.
  EXPECT_EQ(prior.SigmaAngular(), 0.5);
  EXPECT_EQ(prior.SigmaLinear(), 0.02);
  prior.measured->sigma_linear = 0.01;
  ExpectNear(prior.Fused(expected), {seen.angular, {0.8 * 0.3, 0.0, 0.0}});
  EXPECT_LT((prior.Fused(expected).linear_acceleration -
             0.8 * seen.linear_acceleration)
                .norm(),
            kTwistRounding);
  EXPECT_NEAR(prior.SigmaLinear(), 0.02 * std::sqrt(0.2), kTwistRounding);
}

TEST(VelocityPriorTest, IsDrawnToTheLastVelocity) {
  const Rigid3d motion = kPriorTwist.MotionDuring(kInterval) * kPrevFromRef;
  VelocityModel model;
  EXPECT_FALSE(model.last().has_value());
  ExpectNear(model.Prior(kPrevFromRef, kInterval, 0.0).Mean(motion, Twist()),
             kPriorTwist);
  const Twist last = {{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}};
  model.Add(last, 0.0, 0.0);
  const auto mean = [&] {
    return model.Prior(kPrevFromRef, kInterval, 0.0).Mean(motion, Twist());
  };
  ExpectNear(mean(), 0.8 * kPriorTwist + 0.2 * last);
  const Twist better = {{0.5, 0.0, 0.1}, {0.0, 0.3, 0.0}};
  model.Correct(better, 0.0);
  ExpectNear(*model.last(), better);
  ExpectNear(mean(), 0.8 * kPriorTwist + 0.2 * better);
  model.Reset();
  EXPECT_FALSE(model.last().has_value());
  ExpectNear(mean(), kPriorTwist);
}

// The sigma is half of the change of velocity since the last frame at recent
// accelerations.
TEST(VelocityPriorTest, IsAsCertainAsVelocitiesAreSteady) {
  VelocityModel model;
  double time = 0.0;
  const auto add = [&](const Twist& twist) {
    model.Add(twist, time += kInterval, 0.0);
  };
  const auto prior = [&] { return model.Prior(kPrevFromRef, kInterval, 0.0); };
  const VelocityPrior at_first = prior();
  for (int i = 0; i < 100; ++i) add(kPriorTwist);
  const VelocityPrior steady = prior();
  EXPECT_LT(steady.sigma_angular, 0.1 * at_first.sigma_angular);
  EXPECT_LT(steady.sigma_linear, 0.1 * at_first.sigma_linear);
  EXPECT_GT(steady.sigma_angular, 0.0);  // also for a tripod
  EXPECT_GT(steady.sigma_linear, 0.0);
  const Twist change = {{0.4, -0.4, 0.4}, {0.3, 0.3, -0.3}};
  for (int i = 0; i < 100; ++i) add(kPriorTwist + (i % 2) * change);
  // Values from a hundred frames ago count only e^-10.
  constexpr double kForgotten = 1e-4;
  EXPECT_NEAR(prior().sigma_angular, 0.5 * 0.4, kForgotten);
  EXPECT_NEAR(prior().sigma_linear, 0.5 * 0.3, kForgotten);
  const VelocityPrior later = model.Prior(kPrevFromRef, 3.0 * kInterval, 0.0);
  EXPECT_NEAR(later.sigma_angular, 3.0 * prior().sigma_angular, kTwistRounding);
  EXPECT_NEAR(later.sigma_linear, 3.0 * prior().sigma_linear, kTwistRounding);
  model.Reset();
  EXPECT_EQ(prior().sigma_angular, at_first.sigma_angular);
  EXPECT_EQ(prior().sigma_linear, at_first.sigma_linear);
  // The first velocity may come from a correction.
  model.Correct(kPriorTwist, 1e9);
  model.Add(kPriorTwist + change, 1e9 + kInterval, 0.0);
  EXPECT_GT(prior().sigma_angular, at_first.sigma_angular);
}

// Rows are up to half a readout away from the stamp: the mean square is a
// twelfth of the readout's.
TEST(VelocityPriorTest, AccelerationsMoveWhatRowsSee) {
  constexpr double kReadout = 0.028;
  FrameTiming timing;
  timing.color.readout = timing.depth.readout = kReadout;
  const Twist change = {{30.0, -40.0, 0.0}, {0.0, 3.0, 4.0}};
  const auto sigmas = [&]() -> Eigen::Vector2d {
    const MotionMatrix covariance =
        MotionCovarianceOfAcceleration(timing, change);
    return Eigen::Vector2d(covariance(1, 1), covariance(4, 4)).cwiseSqrt();
  };
  const double half_square = kReadout * kReadout / 24.0;
  EXPECT_NEAR(sigmas()[0], 50.0 * half_square, kTwistRounding);
  EXPECT_NEAR(sigmas()[1], 5.0 * half_square, kTwistRounding);
  timing.color.offset = timing.depth.offset = 0.01;
  EXPECT_NEAR(sigmas()[0], 50.0 * (half_square + 0.5e-4), kTwistRounding);
  timing.twist.angular_acceleration = change.angular;
  timing.twist.linear_acceleration = change.linear;
  EXPECT_EQ(sigmas().norm(), 0.0) << "the frame was corrected with it";
}

TEST(VelocityPriorTest, KnowsHowItChanged) {
  VelocityModel model;
  model.Add(kPriorTwist, 1.0, 0.0);
  ExpectNear(model.change(), Twist());
  model.Add(1.5 * kPriorTwist, 1.5, 0.0);
  ExpectNear(model.change(), kPriorTwist);
  model.Reset();
  ExpectNear(model.change(), Twist());
}

TEST(VelocityPriorTest, VelocitiesAreOutdatedAfterHalfASecond) {
  VelocityModel model;
  EXPECT_FALSE(model.IsOutdated(100.0));
  model.Add(kPriorTwist, 10.0, 0.0);
  EXPECT_FALSE(model.IsOutdated(10.4));
  EXPECT_TRUE(model.IsOutdated(10.6));
  model.Add(kPriorTwist, 10.6, 0.0);
  EXPECT_FALSE(model.IsOutdated(10.7));
}

}  // namespace
}  // namespace rgbd_pose
