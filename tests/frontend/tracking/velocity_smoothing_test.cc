#include "frontend/tracking/velocity_smoothing.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace rgbd_pose {
namespace {

constexpr double kSeconds = 1.0 / 15.0;

Twist TwistOf(const MotionVector& v) { return {v.head<3>(), v.tail<3>()}; }

MotionVector VectorOf(const Twist& twist) {
  MotionVector v;
  v << twist.angular, twist.linear;
  return v;
}

// A velocity with errors, of a camera that moves with `kTruth`.
const Twist kTruth = {{0.3, -0.5, 0.2}, {0.2, 0.3, -0.1}};

// How a velocity error turns and shifts the motion, as on a real Kinect.
MotionMatrix MotionByTwist() {
  MotionMatrix by = -0.016 * MotionMatrix::Identity();
  by(4, 0) = -0.02;
  by(3, 1) = 0.02;
  return by;
}

TwistEstimate FoundWith(const MotionVector& error,
                        const MotionMatrix& covariance) {
  TwistEstimate found;
  found.twist = kTruth + TwistOf(error);
  found.covariance = covariance;
  found.motion_by_twist = MotionByTwist();
  return found;
}

TEST(VelocitySmoothingTest, AnExactMeanMendsVelocityAndMotion) {
  MotionVector error;
  error << 0.1, -0.05, 0.02, 0.03, -0.04, 0.06;
  const SmoothedFrame smoothed = Smooth(
      FoundWith(error, IndependentErrors(0.1, 0.05)), MotionMatrix::Zero(),
      {kTruth, IndependentErrors(1e-6, 1e-6), kSeconds});
  EXPECT_LT((VectorOf(smoothed.twist) - VectorOf(kTruth)).norm(), 1e-6);
  EXPECT_LT((smoothed.change + MotionByTwist() * error).norm(), 1e-6);
  EXPECT_LT(smoothed.covariance.norm(), 1e-10);
}

TEST(VelocitySmoothingTest, AnUncertainMeanChangesNothing) {
  const SmoothedFrame smoothed = Smooth(
      FoundWith(MotionVector::Constant(0.1), IndependentErrors(0.1, 0.05)),
      IndependentErrors(1e-3, 1e-3),
      {kTruth, IndependentErrors(1e3, 1e3), kSeconds});
  EXPECT_LT(
      (VectorOf(smoothed.twist - kTruth) - MotionVector::Constant(0.1)).norm(),
      1e-6);
  EXPECT_LT(smoothed.change.norm(), 1e-6);
}

// A camera whose pose is too far ahead seems faster before it.
TEST(VelocitySmoothingTest, ACertainVelocityTellsTheErrorOfTheMotion) {
  MotionVector ahead;  // an error of the motion: points move the other way
  ahead << 0.002, 0.0, -0.001, 0.003, 0.001, -0.002;
  const SmoothedFrame smoothed =
      Smooth(FoundWith(MotionVector::Zero(), IndependentErrors(1e-9, 1e-9)),
             IndependentErrors(0.002, 0.003),
             {kTruth - TwistOf((1.0 / kSeconds) * ahead),
              IndependentErrors(1e-6, 1e-6), kSeconds});
  EXPECT_LT((smoothed.change + ahead).norm(), 1e-6);
}

// Many frames with errors as large as their covariances say.
TEST(VelocitySmoothingTest, ItsErrorsAreAsItSaysAndSmaller) {
  constexpr int kFrames = 4000;
  const Eigen::Vector2d velocity(0.05, 0.03), motion(0.001, 0.002),
      mean(0.03, 0.03);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto sample = [&](const Eigen::Vector2d& sigma) {
    MotionVector v;
    for (int i = 0; i < 6; ++i) v[i] = sigma[i / 3] * normal(random);
    return v;
  };
  double nees = 0.0, before = 0.0, after = 0.0, by_velocity = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const MotionVector e_velocity = sample(velocity);
    const MotionVector e_motion = sample(motion);
    const MotionVector e_mean = sample(mean) - (1.0 / kSeconds) * e_motion;
    const SmoothedFrame smoothed = Smooth(
        FoundWith(e_velocity, IndependentErrors(velocity[0], velocity[1])),
        IndependentErrors(motion[0], motion[1]),
        {kTruth + TwistOf(e_mean), IndependentErrors(mean[0], mean[1]),
         kSeconds});
    const MotionVector left = VectorOf(smoothed.twist - kTruth);
    nees += left.dot(smoothed.covariance.ldlt().solve(left)) / 6.0 / kFrames;
    const MotionVector was = MotionByTwist() * e_velocity + e_motion;
    before += was.squaredNorm();
    after += (was + smoothed.change).squaredNorm();
    by_velocity += (was + MotionByTwist() * (left - e_velocity)).squaredNorm();
  }
  EXPECT_NEAR(nees, 1.0, 0.03);
  EXPECT_LT(after, 0.95 * before);
  EXPECT_LT(after, 0.95 * by_velocity) << "the error of the motion is known";
}

TEST(VelocitySmoothingTest, TheCovarianceTurnsIntoTheAxesOfTheCamera) {
  MotionEstimate estimate;
  estimate.cur_from_prev.rotation =
      Eigen::AngleAxisd(0.5 * 3.14159265358979, Eigen::Vector3d::UnitZ());
  estimate.covariance = IndependentErrors(0.1, 0.2);
  estimate.covariance(3, 3) = 4.0;  // along the previous camera's x
  TwistEstimate velocity;
  velocity.motion_covariance = IndependentErrors(0.05, 0.1);
  const MotionMatrix turned = CovarianceInCurrentAxes(estimate, &velocity);
  EXPECT_NEAR(turned(4, 4), 3.99, 1e-9);
  EXPECT_NEAR(turned(3, 3), 0.03, 1e-9);
  EXPECT_NEAR(turned(0, 0), 0.0075, 1e-12);
  EXPECT_NEAR(CovarianceInCurrentAxes(estimate, nullptr)(3, 3), 0.04, 1e-9);
}

}  // namespace
}  // namespace rgbd_pose
