#include "core/inertial/imu_buffer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// Measurements that are linear in time: interpolation is exact.
ImuSample LinearSample(double t) {
  return {t, {t, 2.0 * t, 0.0}, {1.0 - t, 0.0, 9.8}};
}

ImuBuffer TenSamples() {
  ImuBuffer buffer;
  for (int k = 0; k < 10; ++k) buffer.Add(LinearSample(5.0 + 0.01 * k));
  return buffer;
}

TEST(ImuBufferTest, InterpolatesAtBothEnds) {
  const auto samples = TenSamples().Between(5.013, 5.036);
  ASSERT_EQ(samples.size(), 4u);
  const double stamps[] = {5.013, 5.02, 5.03, 5.036};
  for (int k = 0; k < 4; ++k) {
    const ImuSample expected = LinearSample(stamps[k]);
    EXPECT_NEAR(samples[k].stamp, expected.stamp, 1e-15);
    EXPECT_TRUE(samples[k].gyro.isApprox(expected.gyro, 1e-12));
    EXPECT_TRUE(samples[k].accel.isApprox(expected.accel, 1e-12));
  }
  EXPECT_EQ(samples.front().stamp, 5.013);
  EXPECT_EQ(samples.back().stamp, 5.036);
}

TEST(ImuBufferTest, EndsMayBeSamplesOrLieBetweenTwo) {
  const ImuBuffer buffer = TenSamples();
  const double first = buffer.samples().front().stamp;
  const double last = buffer.samples().back().stamp;
  EXPECT_EQ(buffer.Between(first, last).size(), 10u);
  EXPECT_EQ(buffer.Between(first, buffer.samples()[1].stamp).size(), 2u);
  EXPECT_EQ(buffer.Between(5.011, 5.012).size(), 2u);
}

TEST(ImuBufferTest, ForgetsOnlyWhatIsNotNeeded) {
  ImuBuffer buffer = TenSamples();
  buffer.ForgetBefore(5.025);
  EXPECT_EQ(buffer.samples().size(), 8u);
  EXPECT_EQ(buffer.Between(5.025, 5.04).size(), 3u);
  buffer.ForgetBefore(1.0);
  EXPECT_EQ(buffer.samples().size(), 8u);
  buffer.ForgetBefore(9.0);
  EXPECT_EQ(buffer.samples().size(), 1u);
}

TEST(ImuBufferTest, RefusesWhatItDoesNotCover) {
  const ImuBuffer buffer = TenSamples();
  ExpectInputError([&] { buffer.Between(4.99, 5.02); },
                   {"from 5.000000 s to 5.090000 s do not cover 4.990000 s"});
  ExpectInputError([&] { buffer.Between(5.02, 5.2); }, {"do not cover"});
  ExpectInputError([&] { buffer.Between(5.02, 5.02); }, {"has no length"});
  ExpectInputError([&] { buffer.Between(5.03, 5.02); }, {"has no length"});
  ExpectInputError([&] { buffer.Between(5.02, NAN); }, {"has no length"});
  ExpectInputError([&] { ImuBuffer().Between(1.0, 2.0); },
                   {"there are no inertial samples"});
}

TEST(ImuBufferTest, RefusesAGapOnlyWhereItIs) {
  ImuBuffer buffer = TenSamples();
  buffer.Add(LinearSample(5.25));
  buffer.Add(LinearSample(5.26));
  EXPECT_EQ(buffer.Between(5.0, 5.09).size(), 10u);
  EXPECT_EQ(buffer.Between(5.251, 5.26).size(), 2u);
  ExpectInputError(
      [&] { buffer.Between(5.08, 5.1); },
      {"no inertial sample for 0.160 s after 5.090000 s", "is 0.05 s"});
  EXPECT_THROW(ImuBuffer(0.0), InputError);
}

TEST(ImuBufferTest, RefusesStampsThatDoNotIncreaseAndWhatIsNotFinite) {
  ImuBuffer buffer = TenSamples();
  ExpectInputError([&] { buffer.Add(LinearSample(5.03)); },
                   {"at 5.030000 s is not later than", "at 5.090000 s"});
  ExpectInputError([&] { buffer.Add(LinearSample(NAN)); },
                   {"stamp", "not a finite number"});
  ImuSample sample = LinearSample(5.1);
  sample.gyro[1] = std::numeric_limits<double>::infinity();
  ExpectInputError([&] { buffer.Add(sample); },
                   {"at 5.100000 s is not finite"});
  sample = LinearSample(5.1);
  sample.accel[2] = NAN;
  ExpectInputError([&] { buffer.Add(sample); },
                   {"at 5.100000 s is not finite"});
  EXPECT_EQ(buffer.samples().size(), 10u);
  buffer.Add(LinearSample(5.1));
}

}  // namespace
}  // namespace rgbd_pose
