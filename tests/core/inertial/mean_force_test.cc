#include "core/inertial/mean_force.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/inertial/camera_imu.h"
#include "core/inertial/gravity_estimate.h"
#include "tests/support/camera_with_imu.h"
#include "tests/support/imu_path.h"

namespace rgbd_pose {
namespace {

// A shaking hand with camera and sensor, which sits elsewhere and has a clock
// of its own.
struct Shaken {
  explicit Shaken(double seconds = 4.0, double pose_rate = 60.0) {
    sensor.calibration.cam_from_imu =
        Rigid3d::FromRotationVector({0.5, -1.0, 0.3}, {0.05, -0.1, 0.02});
    sensor.calibration.delay_s = 0.3;
    const Rigid3d imu_from_cam = sensor.calibration.cam_from_imu->Inverse();
    for (int k = 0; k <= seconds * pose_rate; ++k) {
      const PoseOf<double> pose = hand.Pose(k / pose_rate);
      path.push_back({k / pose_rate, Rigid3d(pose.q, pose.p) * imu_from_cam});
    }
    samples = hand.Samples(-0.1, seconds + 0.1, 200.0);
    for (ImuSample& sample : samples) sample.stamp += 0.3;
  }

  ForceMeter Meter() const {
    ForceMeter meter(sensor);
    meter.Add(samples);
    return meter;
  }

  // How far a mean is from the truth, m/s^2.
  double ErrorOf(const MeanForce& force) const {
    return (force.world_from_cam.rotation * force.up_in_cam + hand.gravity)
        .norm();
  }

  ImuPath hand;
  ImuSensor sensor;
  Trajectory path;
  std::vector<ImuSample> samples;
};

// The hand accelerates by up to 6 m/s^2. What is left is how it turns between
// poses.
TEST(ForceMeterTest, TakesOutHowTheCameraTurnsAndAccelerates) {
  const Shaken shaken;
  const std::vector<MeanForce> forces = shaken.Meter().Along(shaken.path);
  ASSERT_EQ(forces.size(), 7);  // each about half a second after the last
  for (const MeanForce& force : forces) {
    EXPECT_LT(shaken.ErrorOf(force), 0.03) << force.at;
  }
}

// A mounting that is wrong by 17 degrees would turn gravity by as much.
TEST(ForceMeterTest, TakesTheMountingThatTurnsHaveShown) {
  CameraWithImu world;
  const std::vector<ImuSample> samples = world.Samples(-0.2, 10.2);
  ImuCalibration wrong = world.truth;
  wrong.cam_from_imu->rotation =
      Rigid3d::FromRotationVector({0.2, -0.2, 0.1}, {0, 0, 0}).rotation *
      wrong.cam_from_imu->rotation;
  CameraImu imu({wrong, true});
  imu.Add(samples);
  world.Teach(0.0, 10.0, 5e-4, &imu);
  Trajectory path;
  for (int k = 0; k <= 600; ++k) {
    path.push_back({k / 60.0, world.WorldFromCam(k / 60.0)});
  }
  ForceMeter meter({wrong, true});
  meter.Add(samples);
  const auto error = [&] {
    const GravityEstimate gravity = EstimateGravity(meter.Along(path));
    EXPECT_TRUE(gravity.ok()) << gravity.refusal;
    return (gravity.up + world.hand.gravity.normalized()).norm();
  };
  meter.CorrectBy(nullptr);
  EXPECT_GT(error(), 0.1);
  // The mounting is found to 0.1 degrees, and gravity with a bias.
  constexpr double kTolerance = 0.01;
  meter.CorrectBy(&imu);
  EXPECT_LT(error(), kTolerance);
}

// Poses at unequal times are as good.
TEST(ForceMeterTest, FramesMayBeMissing) {
  Shaken shaken;
  shaken.path.erase(shaken.path.begin() + 70, shaken.path.begin() + 75);
  const auto force = shaken.Meter().At(shaken.path, 90);
  ASSERT_TRUE(force.has_value());
  EXPECT_LT(shaken.ErrorOf(*force), 0.15);
}

TEST(ForceMeterTest, TheLastTwoPosesMayHaveOneStamp) {
  Shaken shaken;
  shaken.path.resize(127);
  shaken.path.push_back(shaken.path.back());
  const auto force = shaken.Meter().At(shaken.path, 100);
  ASSERT_TRUE(force.has_value());
  EXPECT_LT(shaken.ErrorOf(*force), 0.15);
}

TEST(ForceMeterTest, MeasuresNothingWithoutPosesOrSamplesThroughout) {
  const Shaken shaken;
  const ForceMeter meter = shaken.Meter();
  EXPECT_FALSE(meter.At(shaken.path, 10).has_value());
  EXPECT_TRUE(meter.At(shaken.path, 100).has_value());
  Trajectory lost = shaken.path;
  lost.erase(lost.begin() + 105, lost.begin() + 120);
  EXPECT_FALSE(meter.At(lost, 100).has_value());

  Shaken paused = shaken;
  const auto begin = paused.samples.begin() + 20 + 340;
  paused.samples.erase(begin, begin + 15);  // 75 ms
  EXPECT_FALSE(paused.Meter().At(paused.path, 100).has_value());
  EXPECT_TRUE(paused.Meter().At(paused.path, 180).has_value());

  Shaken unknown = shaken;
  unknown.sensor.calibration.cam_from_imu.reset();
  EXPECT_FALSE(unknown.Meter().At(unknown.path, 100).has_value());
}

TEST(ForceMeterTest, LeavesOutSamplesThatGoBackInTime) {
  Shaken shaken;
  std::swap(shaken.samples[400], shaken.samples[401]);
  const ForceMeter meter = shaken.Meter();
  EXPECT_EQ(meter.samples().size(), shaken.samples.size() - 1);
}

}  // namespace
}  // namespace rgbd_pose
