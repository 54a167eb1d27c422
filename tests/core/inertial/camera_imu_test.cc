#include "core/inertial/camera_imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/util/units.h"
#include "tests/support/camera_with_imu.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// Errors of turns that images show, rad.
constexpr double kTurnSigma = 5e-4;

// From one sample to the next, as one without news is left out, rad/s or m/s^2.
constexpr double kNews = 1e-13;

CameraImu Taught(CameraWithImu* world, const ImuCalibration& calibration,
                 double seconds = 10.0) {
  CameraImu imu({calibration, true});
  imu.Add(world->Samples(-0.2, seconds + 2.0));
  world->Teach(0.0, seconds, kTurnSigma, &imu);
  return imu;
}

double ErrorOf(const CameraTurn& turn, const CameraWithImu& world, double from,
               double to) {
  const Eigen::Quaterniond truth = world.WorldFromCam(to).rotation.conjugate() *
                                   world.WorldFromCam(from).rotation;
  return truth.angularDistance(turn.cur_from_prev);
}

TEST(CameraImuTest, TellsTheTurnsOfTheCamera) {
  CameraWithImu world;
  world.bias.setZero();
  CameraImu imu({world.truth, true});
  imu.Add(world.Samples(-0.2, 3.0));
  for (double t = 0.0; t < 2.0; t += 0.1) {
    const std::optional<CameraTurn> turn = imu.Turn(t, t + 0.1);
    ASSERT_TRUE(turn.has_value());
    EXPECT_LT(ErrorOf(*turn, world, t, t + 0.1), 1e-3);
    const std::optional<CameraRate> rate = imu.Rate(t, t + 0.1);
    ASSERT_TRUE(rate.has_value());
    EXPECT_NEAR((rate->angular * 0.1).norm(),
                RotationVector(turn->cur_from_prev).norm(), 1e-9);
  }
}

// The biases stay in the axes of the sensor.
TEST(CameraImuTest, TurnsTheWholeCovarianceOfAMotion) {
  CameraWithImu world;
  const std::vector<ImuSample> samples = world.Samples(-0.2, 1.0);
  ImuCalibration calibration = world.truth;
  CameraImu mounted({calibration, true});
  calibration.cam_from_imu = Rigid3d();
  CameraImu aligned({calibration, true});
  mounted.Add(samples);
  aligned.Add(samples);
  const auto in_cam = mounted.Motion(0.1, 0.6),
             in_imu = aligned.Motion(0.1, 0.6);
  ASSERT_TRUE(in_cam.has_value() && in_imu.has_value());
  PreintegratedMotion::Covariance turn;
  turn.setIdentity();
  for (int i = 0; i < 9; i += 3) {
    turn.block<3, 3>(i, i) =
        world.truth.cam_from_imu->rotation.toRotationMatrix();
  }
  const PreintegratedMotion::Covariance expected =
      turn * in_imu->covariance * turn.transpose();
  constexpr double kRounding = 1e-12;
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column < 15; ++column) {
      const double size =
          std::sqrt(expected(row, row) * expected(column, column));
      EXPECT_NEAR(in_cam->covariance(row, column), expected(row, column),
                  kRounding * size)
          << row << " " << column;
    }
  }
}

// The bias of its gyroscope, a delay of 12 ms and 3 degrees of its mounting are
// found, with no larger errors than the covariance tells.
TEST(CameraImuTest, LearnsBiasDelayAndMounting) {
  double chi2 = 0.0;
  constexpr int kSeeds = 20;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    CameraWithImu world(seed);
    const Eigen::Vector3d turned(0.03, -0.03, 0.03);  // 3 degrees
    ImuCalibration wrong = world.truth;
    wrong.delay_s = *world.truth.delay_s - 0.012;
    const Eigen::Quaterniond true_from_wrong =
        Rigid3d::FromRotationVector(turned, Eigen::Vector3d::Zero()).rotation;
    wrong.cam_from_imu->rotation =
        true_from_wrong.conjugate() * world.truth.cam_from_imu->rotation;
    const CameraImu imu = Taught(&world, wrong);
    EXPECT_TRUE(imu.is_trusted()) << imu.doubt();
    CameraImu::State error = imu.state();
    error.head<3>() -= world.bias.head<3>();
    error[3] -= 0.012;
    error.tail<3>() -= turned;
    EXPECT_LT(error.head<3>().norm(), 0.003) << seed;
    EXPECT_LT(std::abs(error[3]), 0.0005) << seed;
    EXPECT_LT(error.tail<3>().norm(), 0.1 / kDegreesPerRadian) << seed;
    chi2 += error.dot(imu.covariance().inverse() * error) / 7.0;
  }
  // The error of a pose is in two turns, with opposite signs, so that together
  // they say more than the filter takes from them.
  EXPECT_GT(chi2 / kSeeds, 0.05);
  EXPECT_LT(chi2 / kSeeds, 1.0);
}

// Small errors of a calibration are usual, so that it stays as it is.
TEST(CameraImuTest, CorrectsACalibrationThatIsClearlyWrong) {
  CameraWithImu world;
  EXPECT_FALSE(Taught(&world, world.truth).Correction().has_value());
  ImuCalibration wrong = world.truth;
  wrong.delay_s = *world.truth.delay_s - 0.012;
  ASSERT_TRUE(Taught(&world, wrong).Correction().has_value());
  wrong = world.truth;
  wrong.cam_from_imu->rotation =
      Rigid3d::FromRotationVector({0.03, -0.03, 0.03}, {0, 0, 0}).rotation *
      wrong.cam_from_imu->rotation;
  const auto corrected = Taught(&world, wrong).Correction();
  ASSERT_TRUE(corrected.has_value());
  EXPECT_LT(corrected->cam_from_imu->rotation.angularDistance(
                world.truth.cam_from_imu->rotation),
            0.1 / kDegreesPerRadian);
}

// A sensor whose axes are swapped is not believed.
TEST(CameraImuTest, DoubtsASensorThatContradictsTheImages) {
  CameraWithImu world;
  CameraImu imu({world.truth, true});
  std::vector<ImuSample> samples = world.Samples(-0.2, 12.0);
  for (ImuSample& sample : samples) {
    std::swap(sample.gyro.x(), sample.gyro.z());
  }
  imu.Add(samples);
  world.Teach(0.0, 3.0, kTurnSigma, &imu);
  EXPECT_FALSE(imu.is_trusted());
  EXPECT_NE(imu.doubt().find("contradicts"), std::string::npos);
}

// A sensor that hangs repeats its last sample, from the start or long after it
// was believed; or only one of its parts does.
TEST(CameraImuTest, SaysNothingOnceTheSensorHangs) {
  for (const auto& [part, working] :
       {std::pair(&ImuSample::gyro, 0.0), std::pair(&ImuSample::gyro, 5.0),
        std::pair(&ImuSample::accel, 5.0)}) {
    CameraWithImu world;
    CameraImu imu({world.truth, true});
    std::vector<ImuSample> samples = world.Samples(-0.2, 8.0);
    for (size_t i = 1; i < samples.size(); ++i) {
      if (samples[i].stamp - *world.truth.delay_s > working) {
        samples[i].*part = samples[i - 1].*part;
      }
    }
    imu.Add(samples);
    world.Teach(0.0, 8.0, kTurnSigma, &imu);
    EXPECT_EQ(imu.Turn(4.0, 4.1).has_value(), working > 4.0);
    EXPECT_FALSE(imu.Turn(5.0, 5.2).has_value());
    EXPECT_FALSE(imu.Turn(6.0, 6.1).has_value());
    EXPECT_NE(imu.doubt().find("frozen"), std::string::npos) << imu.doubt();
  }
}

// Turns about y do not show that x and z are swapped. The covariance of a turn
// about x tells so until such turns have been seen.
TEST(CameraImuTest, BelievesOnlyAxesThatTurnsHaveTested) {
  constexpr double kRate = 0.5;  // rad/s
  constexpr double kStep = 0.2;  // s
  CameraImu imu({CameraWithImu().truth, true});
  const double delay = *CameraWithImu().truth.delay_s;
  const Eigen::Quaterniond cam_from_imu =
      CameraWithImu().truth.cam_from_imu->rotation;
  std::vector<ImuSample> samples;
  for (int i = -100; i < 2000; ++i) {
    const double t = 0.005 * i;
    const Eigen::Vector3d rate =
        (kRate + kNews * i) *
        (t < 5.0 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX());
    samples.push_back(
        {t + delay, cam_from_imu.conjugate() * rate, {0, 0, 9.81 + kNews * i}});
  }
  imu.Add(samples);
  const auto sigma = [&](double from) {
    return std::sqrt(imu.Turn(from, from + kStep)->covariance.trace() / 3.0);
  };
  const auto teach = [&](double from, double to, const Eigen::Vector3d& axis) {
    const Eigen::Quaterniond cur_from_prev =
        Rigid3d::FromRotationVector(-kStep * kRate * axis,
                                    Eigen::Vector3d::Zero())
            .rotation;
    for (double t = from; t < to; t += kStep) {
      imu.Learn(t, t + kStep,
                {cur_from_prev,
                 kTurnSigma * kTurnSigma * Eigen::Matrix3d::Identity()});
    }
  };
  EXPECT_GT(sigma(1.0), 0.9 * kRate * kStep);
  teach(0.0, 4.0, Eigen::Vector3d::UnitY());
  EXPECT_LT(sigma(1.0), 0.03 * kRate * kStep);
  EXPECT_GT(sigma(6.0), 0.9 * kRate * kStep);
  teach(6.0, 8.0, Eigen::Vector3d::UnitX());
  EXPECT_LT(sigma(6.0), 0.03 * kRate * kStep);
  EXPECT_TRUE(imu.is_trusted()) << imu.doubt();
}

TEST(CameraImuTest, RefusesNoiseDelaysAndMountingsThatCannotBe) {
  ImuSensor sensor;
  sensor.has_gyro = true;
  sensor.calibration.cam_from_imu = Rigid3d();
  sensor.calibration.delay_s = std::nan("");
  ExpectInputError([&] { CameraImu imu(sensor); }, {"delay"});
  sensor.calibration.delay_s = 0.0;
  sensor.calibration.cam_from_imu->translation.x() = std::nan("");
  ExpectInputError([&] { CameraImu imu(sensor); }, {"mounting"});
  sensor.calibration.cam_from_imu = Rigid3d();
  sensor.calibration.noise = ImuNoise();
  sensor.calibration.noise->gyro_density = -1.0;
  ExpectInputError([&] { CameraImu imu(sensor); }, {"inertial sensor"});
}

TEST(CameraImuTest, OneWrongPoseDoesNotRuinIt) {
  CameraWithImu world;
  CameraImu imu = Taught(&world, world.truth);
  CameraTurn wrong;
  wrong.covariance = kTurnSigma * kTurnSigma * Eigen::Matrix3d::Identity();
  imu.Learn(10.0, 10.2, wrong);
  EXPECT_TRUE(imu.is_trusted()) << imu.doubt();
  EXPECT_LT(ErrorOf(*imu.Turn(11.0, 11.1), world, 11.0, 11.1), 2e-3);
}

TEST(CameraImuTest, SaysNothingWithoutSamplesOrBeyondItsRange) {
  CameraWithImu world;
  CameraImu imu({world.truth, true});
  EXPECT_FALSE(imu.Turn(0.0, 0.1).has_value());
  std::vector<ImuSample> samples = world.Samples(-0.2, 3.0);
  for (ImuSample& sample : samples) {
    sample.gyro = sample.gyro.cwiseMax(-2.5).cwiseMin(2.5);
  }
  imu.Add(samples);
  EXPECT_FALSE(imu.Turn(2.9, 3.5).has_value());
  int missing = 0;
  for (double t = 0.0; t < 2.0; t += 0.1) {
    const std::optional<CameraTurn> turn = imu.Turn(t, t + 0.1);
    missing += !turn.has_value();
    if (turn.has_value()) {
      EXPECT_LT(ErrorOf(*turn, world, t, t + 0.1), 0.01) << t;
    }
  }
  EXPECT_GT(missing, 5);
  EXPECT_LT(missing, 20);
}

// Bits that a cable turns over: single samples are far from their neighbours.
TEST(CameraImuTest, SaysNothingWhereASampleIsASpike) {
  CameraWithImu world;
  world.bias.setZero();
  CameraImu imu({world.truth, true});
  std::vector<ImuSample> samples = world.Samples(-0.2, 3.0);
  for (size_t i = 0; i < samples.size(); i += 97) samples[i].gyro.x() += 20.0;
  imu.Add(samples);
  int missing = 0;
  for (double t = 0.0; t < 2.0; t += 0.1) {
    const std::optional<CameraTurn> turn = imu.Turn(t, t + 0.1);
    missing += !turn.has_value();
    if (turn.has_value()) {
      EXPECT_LT(ErrorOf(*turn, world, t, t + 0.1), 1e-3) << t;
    }
  }
  EXPECT_GT(missing, 0);
  EXPECT_LT(missing, 10);
}

// The rows of a frame take as long as one or two samples: interpolated ones
// would hide a spike beside them.
TEST(CameraImuTest, NoIntervalIsTooShortToShowASpike) {
  constexpr double kStep = 0.01, kSpikeAt = 1.0;  // s
  constexpr double kRate = 0.5, kSpike = 5.0;     // rad/s
  ImuSensor sensor;
  sensor.calibration.cam_from_imu = Rigid3d();
  sensor.calibration.delay_s = 0.0;
  CameraImu imu(sensor);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 200; ++i) {
    samples.push_back({kStep * i,
                       (kRate + kNews * i) * Eigen::Vector3d::UnitX(),
                       {0, 0, 9.81 + kNews * i}});
  }
  samples[100].gyro.x() += kSpike;
  imu.Add(samples);
  for (const double seconds : {0.0025, 0.005, 0.01, 0.033}) {
    for (double from = 0.9; from < 1.1; from += 0.0007) {
      const std::optional<CameraRate> rate = imu.Rate(from, from + seconds);
      const bool is_touched =
          from < kSpikeAt + kStep && from + seconds > kSpikeAt - kStep;
      EXPECT_EQ(rate.has_value(), !is_touched) << from << " " << seconds;
      if (rate.has_value()) {
        EXPECT_NEAR(rate->angular.x(), kRate, 1e-9) << from;
      }
    }
  }
}

// A hand that shakes, where samples were lost: the first one after the gap has
// no neighbour before it.
TEST(CameraImuTest, FastShakingBesideAGapIsNoSpike) {
  constexpr double kStep = 0.02, kGapFrom = 0.5, kGapTo = 0.7;  // s
  constexpr double kRate = 10.0, kHertz = 5.0;                  // rad/s
  ImuSensor sensor;
  sensor.calibration.cam_from_imu = Rigid3d();
  sensor.calibration.delay_s = 0.0;
  CameraImu imu(sensor);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 100; ++i) {
    const double t = kStep * i;
    if (t > kGapFrom && t < kGapTo) continue;
    const double rate = kRate * std::sin(2.0 * M_PI * kHertz * t);
    samples.push_back(
        {t, rate * Eigen::Vector3d::UnitX(), {0, 0, 9.81 + kNews * i}});
  }
  imu.Add(samples);
  EXPECT_FALSE(imu.Turn(0.4, 0.6).has_value());
  for (double from = 0.71; from < 1.8; from += 0.013) {
    EXPECT_TRUE(imu.Turn(from, from + 0.03).has_value()) << from;
  }
}

// A driver that joins an accelerometer of 50 samples a second and a gyroscope
// of 200 by copies, and a gyroscope without an accelerometer.
TEST(CameraImuTest, CopiedOrMissingAccelerationsAreNoFault) {
  for (const double accelerometer : {0.0, 1.0}) {
    CameraWithImu world;
    CameraImu imu({world.truth, true});
    std::vector<ImuSample> samples = world.Samples(-0.2, 3.0);
    for (size_t i = 0; i < samples.size(); ++i) {
      samples[i].accel = accelerometer * samples[i - i % 4].accel;
    }
    imu.Add(samples);
    for (double t = 0.0; t < 2.0; t += 0.1) {
      EXPECT_TRUE(imu.Turn(t, t + 0.1).has_value()) << accelerometer << t;
    }
  }
}

TEST(CameraImuTest, SaysWhichSamplesAreMissing) {
  CameraWithImu world;
  CameraImu imu({world.truth, true});
  world.Teach(0.0, 3.0, kTurnSigma, &imu);
  EXPECT_NE(imu.doubt().find("same clock"), std::string::npos) << imu.doubt();
  const std::vector<ImuSample> samples = world.Samples(-0.2, 3.2);
  std::vector<ImuSample> few;
  for (size_t i = 0; i < samples.size(); i += 20) few.push_back(samples[i]);
  imu.Add(few);
  world.Teach(0.0, 3.0, kTurnSigma, &imu);
  EXPECT_NE(imu.doubt().find("10 samples per second"), std::string::npos)
      << imu.doubt();
}

TEST(CameraImuTest, CannotUseASensorWithoutGyroscopeOrMounting) {
  const CameraWithImu world;
  EXPECT_TRUE(CameraImu::CanUse({world.truth, true}));
  EXPECT_FALSE(CameraImu::CanUse({world.truth, false}));
  EXPECT_FALSE(CameraImu::CanUse({ImuCalibration(), true}));
}

}  // namespace
}  // namespace rgbd_pose
