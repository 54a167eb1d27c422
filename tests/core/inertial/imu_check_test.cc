#include "core/inertial/imu_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/imu_path.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;

constexpr double kDegrees = 57.29577951308232;

// Ten seconds of a shaking hand, with the noise and the biases of a consumer
// sensor, and with a mistake.
ImuFindings Examine(const std::function<void(ImuSample*)>& mistake) {
  ImuBiasVector bias;
  bias << 0.01, -0.01, 0.01, 0.1, 0.1, -0.1;
  ImuErrors errors(ImuNoise(), bias, 1);
  auto samples = errors.On(ImuPath().Samples(0.0, 10.0, 200.0), 200.0);
  for (ImuSample& sample : samples) mistake(&sample);
  return ExamineImu(samples);
}

TEST(ImuCheckTest, SaysNothingOfRightUnits) {
  const ImuFindings findings = Examine([](ImuSample*) {});
  EXPECT_EQ(findings.error, "");
  EXPECT_EQ(findings.warning, "");
  EXPECT_EQ(ExamineImu({}).error, "");
}

TEST(ImuCheckTest, FindsUnitsOfAccelerations) {
  EXPECT_THAT(Examine([](ImuSample* s) { s->accel /= 9.81; }).error,
              HasSubstr("gravity is in g; m/s^2 are needed: multiply them by "
                        "9.81"));
  EXPECT_THAT(Examine([](ImuSample* s) { s->accel *= 1000.0 / 9.81; }).error,
              HasSubstr("thousandths of g"));
  EXPECT_THAT(Examine([](ImuSample* s) { s->accel *= 1000.0; }).error,
              HasSubstr("mm/s^2; m/s^2 are needed: multiply them by 0.001"));
}

TEST(ImuCheckTest, FindsExchangedColumnsAndMissingGravity) {
  EXPECT_THAT(Examine([](ImuSample* s) { std::swap(s->gyro, s->accel); }).error,
              HasSubstr("exchanged"));
  EXPECT_THAT(Examine([](ImuSample* s) { s->accel *= 0.3; }).warning,
              HasSubstr("gravity is 9.81"));
}

// A slow hand never turns faster than a sensor could measure in rad/s; a fast
// one does.
TEST(ImuCheckTest, FindsDegrees) {
  const auto in_degrees = [](ImuSample* s) { s->gyro *= kDegrees; };
  EXPECT_THAT(Examine(in_degrees).error,
              HasSubstr("degrees per second; rad/s are needed: multiply by "
                        "0.017453293"));
  // A tenth of the speed: the same path takes ten times as long.
  std::vector<ImuSample> slow = ImuPath().Samples(0.0, 10.0, 500.0);
  for (ImuSample& s : slow) {
    s.stamp *= 10.0;
    s.gyro *= 0.1;
    s.accel = ImuPath().Pose(0.1 * s.stamp).q.conjugate() *
              Eigen::Vector3d(-0.3, 0.2, 9.8);
  }
  EXPECT_EQ(ExamineImu(slow).error, "");
  for (ImuSample& s : slow) s.gyro *= kDegrees;
  double fastest = 0.0;
  for (const ImuSample& s : slow) fastest = std::max(fastest, s.gyro.norm());
  ASSERT_LT(fastest, 40.0);
  EXPECT_THAT(ExamineImu(slow).error, HasSubstr("in degrees per second"));
  slow[100].gyro.x() = std::nan("");
  EXPECT_THAT(ExamineImu(slow).error, HasSubstr("in degrees per second"))
      << "a single sample that is no number hides the mistake";
}

// A bit that a cable turns over is no unit.
TEST(ImuCheckTest, ASingleSampleIsNotTakenForDegrees) {
  int count = 0;
  const ImuFindings findings = Examine([&count](ImuSample* s) {
    if (++count % 500 == 0) s->gyro.x() = 65.0;
  });
  EXPECT_EQ(findings.error, "");
  EXPECT_EQ(findings.warning, "");
  EXPECT_THAT(ExamineImu({{0.0, {65.0, 0.0, 0.0}, {0.0, 0.0, 9.81}}}).error,
              HasSubstr("in degrees per second"));
}

TEST(ImuCheckTest, SaysWhichAxesFitGravity) {
  EXPECT_THAT(
      Examine([](ImuSample* s) {
        s->gyro = Eigen::Vector3d(s->gyro.y(), -s->gyro.x(), s->gyro.z());
      }).warning,
      HasSubstr("of the accelerometer are (-y, x, z) of the gyroscope"));
  EXPECT_THAT(Examine([](ImuSample* s) { s->gyro = -s->gyro; }).warning,
              HasSubstr("(-x, -y, -z)"));
}

// At rest nothing but the size of gravity can be tested.
TEST(ImuCheckTest, SaysNothingOfWhatTheMotionDoesNotShow) {
  ImuErrors errors(ImuNoise(), ImuBiasVector::Constant(0.02), 1);
  std::vector<ImuSample> samples;
  for (int k = 0; k < 2000; ++k) {
    samples.push_back({k / 200.0, {0, 0, 0}, {0, 0, 9.81}});
  }
  const ImuFindings findings = ExamineImu(errors.On(samples, 200.0));
  EXPECT_EQ(findings.error, "");
  EXPECT_EQ(findings.warning, "");
  // A few windows show nothing.
  samples.resize(3);
  EXPECT_EQ(ExamineImu(samples).warning, "");
}

}  // namespace
}  // namespace rgbd_pose
