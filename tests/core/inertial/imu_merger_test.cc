#include "core/inertial/imu_merger.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

std::vector<double> StampsOf(const std::vector<ImuSample>& samples) {
  std::vector<double> stamps;
  for (const ImuSample& sample : samples) stamps.push_back(sample.stamp);
  return stamps;
}

TEST(ImuMergerTest, InterpolatesAccelerationsAtTheStampsOfTheGyroscope) {
  ImuMerger merger;
  merger.AddAccel(1.00, {0.0, 0.0, 10.0});
  merger.AddGyro(0.99, Vector3d::Ones());
  merger.AddGyro(1.005, {0.1, 0.2, 0.3});
  EXPECT_TRUE(merger.Take().empty()) << "the next acceleration is not known";
  merger.AddAccel(1.02, {2.0, 0.0, 14.0});
  merger.AddGyro(1.015, {0.4, 0.5, 0.6});
  merger.AddGyro(1.025, {0.7, 0.8, 0.9});
  const std::vector<ImuSample> samples = merger.Take();
  ASSERT_EQ(StampsOf(samples), (std::vector<double>{1.005, 1.015}));
  EXPECT_EQ(samples[0].gyro, Vector3d(0.1, 0.2, 0.3));
  constexpr double kTolerance = 1e-9;  // rounding of the stamps
  EXPECT_TRUE(samples[0].accel.isApprox(Vector3d(0.5, 0.0, 11.0), kTolerance));
  EXPECT_TRUE(samples[1].accel.isApprox(Vector3d(1.5, 0.0, 13.0), kTolerance));
  EXPECT_TRUE(merger.Take().empty());
  merger.AddAccel(1.04, {2.0, 0.0, 14.0});
  EXPECT_EQ(StampsOf(merger.Take()), (std::vector<double>{1.025}));
}

TEST(ImuMergerTest, InventsNothingWhereTheAccelerometerPauses) {
  ImuMerger merger;
  for (int k = 0; k < 100; ++k) merger.AddGyro(0.005 * k, Vector3d::Zero());
  for (const double stamp : {0.0, 0.01, 0.02, 0.20, 0.21}) {
    merger.AddAccel(stamp, {0.0, 0.0, 9.81});
  }
  EXPECT_EQ(
      StampsOf(merger.Take()),
      (std::vector<double>{0.0, 0.005, 0.01, 0.015, 0.02, 0.20, 0.005 * 41}));
}

TEST(ImuMergerTest, LeavesOutWhatIsNotLater) {
  ImuMerger merger;
  merger.AddGyro(0.005, Vector3d::UnitX());
  merger.AddGyro(0.005, Vector3d::UnitY());
  merger.AddAccel(0.0, {0.0, 0.0, 9.0});
  merger.AddAccel(0.0, {0.0, 0.0, 1.0});
  merger.AddAccel(0.01, {0.0, 0.0, 9.0});
  const std::vector<ImuSample> samples = merger.Take();
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].gyro, Vector3d::UnitX());
  EXPECT_EQ(samples[0].accel.z(), 9.0);
  // Also once the one before is taken.
  merger.AddGyro(0.005, Vector3d::UnitY());
  merger.AddGyro(0.002, Vector3d::UnitY());
  EXPECT_TRUE(merger.Take().empty());
  merger.AddGyro(0.007, Vector3d::UnitZ());
  EXPECT_EQ(StampsOf(merger.Take()), (std::vector<double>{0.007}));
}

TEST(ImuMergerTest, AStampThatIsNoNumberHidesNothing) {
  ImuMerger merger;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  merger.AddGyro(kNone, Vector3d::UnitX());
  merger.AddAccel(kNone, {0.0, 0.0, 9.0});
  merger.AddGyro(0.005, Vector3d::UnitX());
  merger.AddAccel(0.0, {0.0, 0.0, 9.0});
  merger.AddAccel(0.01, {0.0, 0.0, 9.0});
  EXPECT_EQ(StampsOf(merger.Take()), (std::vector<double>{0.005}));
}

}  // namespace
}  // namespace rgbd_pose
