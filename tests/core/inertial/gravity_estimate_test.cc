#include "core/inertial/gravity_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

constexpr double kNoise = 0.05;  // m/s^2, of each axis of a mean

// Means of an accelerometer with this bias along a path that turns by up to
// `turn` (rad) to all sides.
std::vector<MeanForce> Means(int count, double turn, unsigned seed = 1,
                             const Eigen::Vector3d& gravity = {0, 9.8, 0},
                             const Eigen::Vector3d& bias = {0.1, -0.1, 0.2}) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(-turn, turn);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<MeanForce> means;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d axis(angle(random), angle(random), angle(random));
    MeanForce mean;
    mean.world_from_cam = Rigid3d::FromRotationVector(axis, {0, 0, 0});
    mean.up_in_cam =
        mean.world_from_cam.rotation.conjugate() * -gravity + bias +
        Eigen::Vector3d(noise(random), noise(random), noise(random));
    means.push_back(mean);
  }
  return means;
}

double AngleToUp(const GravityEstimate& estimate) {
  return std::acos(std::min(1.0, -estimate.up.y()));
}

TEST(GravityEstimateTest, TellsGravityFromTheBiasByTurns) {
  const GravityEstimate estimate = EstimateGravity(Means(60, 0.8));
  ASSERT_EQ(estimate.refusal, "");
  EXPECT_LT(AngleToUp(estimate), 0.003);
  EXPECT_LT(estimate.sigma, 0.003);
  EXPECT_LT((estimate.bias - Eigen::Vector3d(0.1, -0.1, 0.2)).norm(), 0.04);
  EXPECT_NEAR(estimate.acceleration, 9.8, 0.03);
  EXPECT_NEAR(estimate.scatter, kNoise, 0.015);
}

// Two angles, in sigmas, have a mean square of 2.
TEST(GravityEstimateTest, ErrorsAreThoseOfItsSigma) {
  constexpr int kRuns = 100;
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(100 + run);
    std::normal_distribution<double> normal(0.0, kAccelBiasSigma);
    const Eigen::Vector3d bias(normal(random), normal(random), normal(random));
    const GravityEstimate estimate =
        EstimateGravity(Means(20, 0.3, run, {0, 9.8, 0}, bias));
    sum += std::pow(AngleToUp(estimate) / estimate.sigma, 2);
  }
  EXPECT_GT(sum / kRuns, 0.8);
  EXPECT_LT(sum / kRuns, 2.6);
}

TEST(GravityEstimateTest, WithoutTurnsItIsAsUncertainAsTheBias) {
  const GravityEstimate estimate = EstimateGravity(Means(60, 0.0));
  ASSERT_TRUE(estimate.ok());
  EXPECT_NEAR(estimate.sigma, kAccelBiasSigma / 9.8, 0.002);
}

TEST(GravityEstimateTest, AFewWrongMeansDoNotMatter) {
  std::vector<MeanForce> means = Means(40, 0.8);
  for (int i = 0; i < 8; ++i) means[i].up_in_cam.x() += 5.0;
  const GravityEstimate estimate = EstimateGravity(means);
  ASSERT_TRUE(estimate.ok());
  EXPECT_LT(AngleToUp(estimate), 0.006);
}

TEST(GravityEstimateTest, RefusesWhatDoesNotDetermineIt) {
  const auto refusal = [](const std::vector<MeanForce>& means) {
    return EstimateGravity(means).refusal;
  };
  EXPECT_THAT(refusal(Means(2, 0.8)), HasSubstr("2 parts of the path"));
  EXPECT_THAT(refusal(Means(40, 0.8, 1, {0, 0, 0})), HasSubstr("not gravity"));
  EXPECT_THAT(refusal(Means(40, 0.8, 1, {0, 1, 0})), HasSubstr("not gravity"));
  // Axes that are exchanged follow the turns of the camera wrongly.
  std::vector<MeanForce> exchanged = Means(40, 0.8);
  for (MeanForce& mean : exchanged) {
    std::swap(mean.up_in_cam.x(), mean.up_in_cam.z());
  }
  EXPECT_THAT(refusal(exchanged), HasSubstr("not gravity"));
  std::vector<MeanForce> shaken = Means(40, 0.8);
  for (int i = 0; i < 40; ++i) shaken[i].up_in_cam.x() += i % 2 == 0 ? 2 : -2;
  EXPECT_THAT(refusal(shaken), HasSubstr("scatter by"));
  EXPECT_THAT(refusal(Means(40, 0.8, 1, {0, 9.8, 0}, {0, 0, 2.5})),
              HasSubstr("its mounting may be wrong"));
  std::vector<MeanForce> unknown = Means(40, 0.8);
  unknown[7].up_in_cam.x() = std::nan("");
  EXPECT_THAT(refusal(unknown), HasSubstr("is not finite"));
}

TEST(GravityEstimateTest, RefusesASensorWithoutMountingOrSamples) {
  EXPECT_THAT(EstimateGravity(ForceMeter(ImuSensor()), {}).refusal,
              HasSubstr("T_cam_imu"));
  ImuSensor sensor;
  sensor.calibration.cam_from_imu = Rigid3d();
  ForceMeter meter(sensor);
  EXPECT_THAT(EstimateGravity(meter, {}).refusal,
              HasSubstr("no inertial samples"));
}

// A camera at rest, of which one segment has more frames than the other.
TEST(GravityEstimateTest, IsThatOfTheWorldWithTheMostPoses) {
  ImuSensor sensor;
  sensor.calibration.cam_from_imu = Rigid3d();
  ForceMeter meter(sensor);
  std::vector<ImuSample> samples;
  for (int k = 0; k < 800; ++k) {
    samples.push_back({0.01 * k, {0, 0, 0}, {0, -9.8, 0}});
  }
  meter.Add(samples);
  const Rigid3d turned(Eigen::Quaterniond(0, 1, 0, 0), {1, 2, 3});
  std::map<int, Trajectory> paths;
  for (int k = 1; k < 79; ++k) {
    paths[k < 30 ? 0 : 1].push_back({0.1 * k, k < 30 ? Rigid3d() : turned});
  }
  const GravityEstimate estimate = EstimateGravity(meter, paths);
  ASSERT_EQ(estimate.refusal, "");
  EXPECT_EQ(estimate.segment, 1);
  EXPECT_NEAR(estimate.up.y(), 1.0, 1e-9);
}

}  // namespace
}  // namespace rgbd_pose
