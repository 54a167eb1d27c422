#include "frontend/simulation/synthetic_imu.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/inertial/imu_buffer.h"
#include "costs/factors/inertial.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

Rigid3d Handheld(double t) { return FindSyntheticPath("handheld")(t, 10.0); }

SyntheticImuOptions Exact() {
  SyntheticImuOptions options;
  options.noise = false;
  return options;
}

TEST(SyntheticImuTest, MeasuresARotationAndItsLever) {
  SyntheticImuOptions options = Exact();
  // 3 rad/s about the camera's z axis, which is level; the sensor is 2 cm off
  // along x and turned by a quarter about z.
  options.cam_from_imu =
      Rigid3d::FromRotationVector({0.0, 0.0, M_PI / 2.0}, {0.02, 0.0, 0.0});
  const auto path = [](double t) {
    return Rigid3d(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX()) *
                       Eigen::AngleAxisd(3.0 * t, Eigen::Vector3d::UnitZ()),
                   {1.0, 2.0, 3.0});
  };
  const auto samples = SimulateImu(path, 0.0, 0.0, options);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_LT((samples[0].gyro - Eigen::Vector3d(0, 0, 3)).norm(), 1e-9);
  // 0.18 m/s^2 towards the axis, which is along the sensor's y; gravity is
  // along the camera's y at t = 0, the sensor's x.
  EXPECT_LT((samples[0].accel - Eigen::Vector3d(9.81, 0.18, 0)).norm(), 1e-7);
}

// The factor, which was tested along another path, fits: at 2,000 Hz the sum
// differs from the path by less than 0.01 mm in half a second.
TEST(SyntheticImuTest, FitsThePath) {
  SyntheticImuOptions options = Exact();
  options.rate_hz = 2000.0;
  options.cam_from_imu =
      Rigid3d::FromRotationVector({0.3, -0.5, 1.0}, {0.02, -0.01, 0.005});
  const InertialFactor factor = [&] {
    InertialFactor result(Preintegrate(SimulateImu(Handheld, 1.0, 1.5, options),
                                       ImuBiasVector::Zero(), ImuNoise()),
                          {0, 0, -9.81});
    result.sqrt_information.setIdentity();
    return result;
  }();
  const auto pose = [&](double t) {
    return PoseFrom(Handheld(t) * options.cam_from_imu);
  };
  const auto velocity = [&](double t) -> Eigen::Vector3d {
    return (pose(t + 1e-5).p - pose(t - 1e-5).p) / 2e-5;
  };
  Eigen::Matrix<double, 15, 1> r;
  factor.Residual(
      pose(1.0), velocity(1.0), ImuBiasVector(ImuBiasVector::Zero()), pose(1.5),
      velocity(1.5), ImuBiasVector(ImuBiasVector::Zero()), r.data());
  EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-5) << r.transpose();
}

TEST(SyntheticImuTest, ADelayMovesStamps) {
  SyntheticImuOptions options = Exact();
  const auto exact = SimulateImu(Handheld, 1.0, 2.0, options);
  options.delay_s = 0.01;  // two samples
  const auto late = SimulateImu(Handheld, 1.0, 2.0, options);
  ASSERT_EQ(late.size(), 201u);
  EXPECT_EQ(late[2].stamp, exact[2].stamp);
  EXPECT_LT((late[2].gyro - exact[0].gyro).norm(), 1e-9);
  EXPECT_GT((late[2].gyro - exact[2].gyro).norm(), 1e-3);
}

TEST(SyntheticImuTest, NoiseHasItsDensitiesAndBiasesWalk) {
  SyntheticImuOptions options;
  options.densities = {1e-3, 1e-2, 1e-2, 1e-1};
  const auto still = [](double) { return Rigid3d(); };
  double white = 0.0, walk = 0.0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    options.seed = run + 1;
    const auto samples = SimulateImu(still, 0.0, 2.0, options);
    walk += samples.back().gyro.squaredNorm() / 3.0 / kRuns;
    white += (samples[1].accel - samples[0].accel).squaredNorm() / 6.0 / kRuns;
  }
  EXPECT_NEAR(white, 1e-4 * 200.0, 0.1 * 1e-4 * 200.0);
  // 2 s of walk, and the white noise of a sample.
  EXPECT_NEAR(walk, 2e-4 + 2e-4, 0.25 * 4e-4);
  const auto again = SimulateImu(still, 0.0, 2.0, options);
  EXPECT_EQ(again.back().accel,
            SimulateImu(still, 0.0, 2.0, options).back().accel);
}

TEST(SyntheticImuTest, FaultsOfAxesAndRange) {
  SyntheticImuOptions options = Exact();
  options.bias << 0, 0, 0.5, 0, 0, 1.0;
  options.accel_axes(2, 2) = 1.02;
  options.accel_limit = 12.0;
  const auto still = [](double) { return Rigid3d(); };
  const auto samples = SimulateImu(still, 0.0, 0.0, options);
  EXPECT_NEAR(samples[0].accel.z(), 1.02 * 9.81 + 1.0, 1e-6);
  EXPECT_NEAR(samples[0].gyro.z(), 0.5, 1e-9);
  options.accel_limit = 10.0;
  EXPECT_EQ(SimulateImu(still, 0.0, 0.0, options)[0].accel.z(), 10.0);
}

// The stream of a rendered sequence has the stamps and the motion of its
// frames.
TEST(SyntheticImuTest, BelongsToASequence) {
  SyntheticOptions sequence;
  sequence.path = "handheld";
  sequence.frames = 31;
  const SyntheticDataset dataset(sequence);
  SyntheticImuOptions options = Exact();
  options.rate_hz = 1000.0;
  ImuBuffer buffer;
  for (const ImuSample& sample : dataset.SimulateImu(options)) {
    buffer.Add(sample);
  }
  const auto motion =
      Preintegrate(buffer.Between(dataset.timestamp(0), dataset.timestamp(30)),
                   ImuBiasVector::Zero(), ImuNoise());
  const Rigid3d moved =
      dataset.WorldFromCam(0).Inverse() * dataset.WorldFromCam(30);
  // Stamps are whole microseconds, and the camera turns by up to 1.5 rad/s.
  EXPECT_LT(motion.start_from_end.angularDistance(moved.rotation), 1e-5);
  EXPECT_GT(moved.Angle(), 0.1);
  options.delay_s = 0.02;
  ExpectInputError([&] { dataset.SimulateImu(options); }, {"delay_s"});
}

TEST(SyntheticImuTest, RefusesBadOptions) {
  SyntheticImuOptions options;
  options.rate_hz = 0.0;
  ExpectInputError([&] { SimulateImu(Handheld, 0, 1, options); },
                   {"rate_hz of the inertial sensor"});
  options = {};
  options.densities.gyro_walk = -1.0;
  ExpectInputError([&] { SimulateImu(Handheld, 0, 1, options); },
                   {"must be above 0, not -1"});
}

}  // namespace
}  // namespace rgbd_pose
