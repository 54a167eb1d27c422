#include "core/inertial/dead_reckoning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/geometry/twist.h"
#include "tests/support/camera_with_imu.h"

namespace rgbd_pose {
namespace {

constexpr double kTurnSigma = 5e-4;   // rad
constexpr double kShiftSigma = 1e-3;  // m

// A camera at 30 Hz whose images have shown ten seconds, and nothing since.
struct Blind {
  explicit Blind(unsigned seed) : world(seed), imu({world.truth, true}) {
    imu.Add(world.Samples(-0.2, 13.0));
    world.Teach(0.0, 10.0, kTurnSigma, &imu);
    for (int frame = 0; frame <= 300; ++frame) {
      last = world.Seen(frame / 30.0, kTurnSigma, kShiftSigma);
      path.Add(imu, frame / 30.0, last);
    }
  }

  std::optional<DeadReckoning::Motion> After(double seconds) const {
    return path.Predict(imu, 10.0 + seconds);
  }

  // What a motion is off, [omega C] as in MotionEstimate. The last pose itself
  // errs, which the covariance of a motion does not say.
  MotionVector ErrorOf(const Rigid3d& cur_from_last, double seconds) const {
    const Rigid3d truth =
        world.WorldFromCam(10.0 + seconds).Inverse() * world.WorldFromCam(10.0);
    MotionVector error;
    error << RotationVector(truth.rotation *
                            cur_from_last.rotation.conjugate()),
        truth.Inverse().translation - cur_from_last.Inverse().translation;
    return error;
  }

  CameraWithImu world;
  CameraImu imu;
  DeadReckoning path;
  Rigid3d last;
};

TEST(DeadReckoningTest, GoesOnForTwoSeconds) {
  constexpr double kLimits[][2] = {{0.5, 0.006}, {1.0, 0.015}, {2.0, 0.04}};
  constexpr int kSeeds = 20;
  double sums[3] = {}, chi2[3] = {};
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Blind blind(seed);
    for (int k = 0; k < 3; ++k) {
      const double seconds = kLimits[k][0];
      const auto motion = blind.After(seconds);
      ASSERT_TRUE(motion.has_value());
      const MotionVector error = blind.ErrorOf(motion->cur_from_last, seconds);
      sums[k] += error.tail<3>().squaredNorm();
      const Eigen::Matrix3d position =
          motion->covariance.bottomRightCorner<3, 3>();
      chi2[k] +=
          error.tail<3>().dot(position.inverse() * error.tail<3>()) / 3.0;
      EXPECT_LT(error.head<3>().norm(), 0.01) << seed;
    }
  }
  for (int k = 0; k < 3; ++k) {
    const auto& [seconds, limit] = kLimits[k];
    EXPECT_LT(std::sqrt(sums[k] / kSeeds), limit) << seconds;
    EXPECT_GT(chi2[k] / kSeeds, 0.05) << seconds;
    EXPECT_LT(chi2[k] / kSeeds, 1.5) << seconds;
  }
}

// While images show the way: a velocity between two frames.
TEST(DeadReckoningTest, KnowsTheVelocityOfTheCamera) {
  constexpr double kAfter = 0.03;  // s
  double sum = 0.0, chi2 = 0.0;
  constexpr int kSeeds = 20;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Blind blind(seed);
    constexpr double kStep = 1e-3;
    const double now = 10.0 + kAfter;
    const Twist truth =
        TwistOf(blind.world.WorldFromCam(now + kStep).Inverse() *
                    blind.world.WorldFromCam(now - kStep),
                2.0 * kStep);
    const auto velocity = blind.path.VelocityAt(blind.imu, now, truth.angular);
    ASSERT_TRUE(velocity.has_value());
    const Eigen::Vector3d error = velocity->linear - truth.linear;
    sum += error.squaredNorm();
    chi2 += error.dot(velocity->covariance.inverse() * error) / 3.0;
  }
  EXPECT_LT(std::sqrt(sum / kSeeds), 0.01);
  EXPECT_GT(chi2 / kSeeds, 0.05);
  EXPECT_LT(chi2 / kSeeds, 1.5);
  const Blind blind(1);
  EXPECT_FALSE(blind.path.VelocityAt(blind.imu, 9.9, Eigen::Vector3d::Zero())
                   .has_value());
}

// Before images have shown a turn about an axis, what the gyroscope says of one
// may be wrong altogether, and with it where gravity pulls.
TEST(DeadReckoningTest, AnUntestedTurnMakesThePositionUncertain) {
  constexpr double kGravity = 9.81;  // m/s^2
  constexpr double kSeen = 2.0;      // s
  constexpr double kNews = 1e-13;    // from sample to sample
  // The camera stands still, but then the gyroscope claims that it turns.
  const Eigen::Vector3d rate(0.0, 0.0, 1.0);
  const double delay = *CameraWithImu().truth.delay_s;
  CameraImu imu({CameraWithImu().truth, true});
  const Eigen::Quaterniond cam_from_imu =
      CameraWithImu().truth.cam_from_imu->rotation;
  std::vector<ImuSample> samples;
  for (int i = -100; i < 700; ++i) {
    const double t = 0.005 * i;
    samples.push_back({t + delay,
                       cam_from_imu.conjugate() *
                           ((t < kSeen ? kNews * i : 1.0 + kNews * i) * rate),
                       cam_from_imu.conjugate() *
                           Eigen::Vector3d(0.0, -kGravity - kNews * i, 0.0)});
  }
  imu.Add(samples);
  DeadReckoning path;
  for (int frame = 0; frame <= 60; ++frame) {
    path.Add(imu, frame / 30.0, Rigid3d());  // until kSeen
  }
  const auto expect_covered = [](const Eigen::Vector3d& off,
                                 const Eigen::Matrix3d& covariance) {
    constexpr double kSigmas = 2.0;
    EXPECT_GT(off.norm(), 1.0);
    EXPECT_LT(off.norm(), kSigmas * std::sqrt(covariance.trace()));
  };
  const auto motion = path.Predict(imu, kSeen + 1.0);
  ASSERT_TRUE(motion.has_value());
  expect_covered(motion->cur_from_last.Inverse().translation,
                 motion->covariance.bottomRightCorner<3, 3>());
  const auto velocity = path.VelocityAt(imu, kSeen + 1.0, rate);
  ASSERT_TRUE(velocity.has_value());
  expect_covered(velocity->linear, velocity->covariance);
}

TEST(DeadReckoningTest, EndsAfterTwoSeconds) {
  const Blind blind(1);
  EXPECT_TRUE(blind.After(DeadReckoning::kMaxBlind).has_value());
  EXPECT_FALSE(blind.After(DeadReckoning::kMaxBlind + 0.01).has_value());
  EXPECT_FALSE(blind.After(0.0).has_value());
}

TEST(DeadReckoningTest, NeedsAPathWithSamples) {
  const Blind blind(1);
  DeadReckoning path;
  EXPECT_FALSE(path.needed_from().has_value());
  EXPECT_FALSE(path.Predict(blind.imu, 0.5).has_value());
  for (int frame = 0; frame < 5; ++frame) {
    path.Add(blind.imu, frame / 30.0, blind.world.WorldFromCam(frame / 30.0));
  }
  EXPECT_FALSE(path.Predict(blind.imu, 0.3).has_value());  // too short
  EXPECT_EQ(path.needed_from(), 0.0);
  for (int frame = 5; frame < 40; ++frame) {
    path.Add(blind.imu, frame / 30.0, blind.world.WorldFromCam(frame / 30.0));
  }
  EXPECT_TRUE(path.Predict(blind.imu, 1.5).has_value());
  EXPECT_FALSE(path.Predict(CameraImu({blind.world.truth, true}), 1.5)
                   .has_value());  // no samples
  path.Clear();
  EXPECT_FALSE(path.Predict(blind.imu, 1.5).has_value());
}

}  // namespace
}  // namespace rgbd_pose
