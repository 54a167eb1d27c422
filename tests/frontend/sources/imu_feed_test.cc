#include "frontend/sources/imu_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rgbd_pose {
namespace {

ImuSample At(double stamp) {
  return {stamp, Eigen::Vector3d::Zero(), {0.0, 0.0, 9.81}};
}

std::vector<double> StampsOf(const std::vector<ImuSample>& samples) {
  std::vector<double> stamps;
  for (const ImuSample& sample : samples) stamps.push_back(sample.stamp);
  return stamps;
}

TEST(ImuFeedTest, GivesEachSampleOnceAndReachesBeyondTheFrame) {
  ImuFeed feed;
  for (int k = 0; k <= 6; ++k) feed.Add(At(k / 20.0));
  EXPECT_TRUE(feed.Covers(0.1));
  EXPECT_FALSE(feed.Covers(0.16));
  // 0.05 s and kReach are 0.2 s, which is a sample.
  EXPECT_THAT(StampsOf(feed.Take(0.049)),
              testing::ElementsAre(0.0, 0.05, 0.1, 0.15, 0.2));
  EXPECT_THAT(StampsOf(feed.Take(0.06)), testing::ElementsAre(0.25));
  EXPECT_THAT(feed.Take(0.06), testing::IsEmpty());
  EXPECT_THAT(StampsOf(feed.Take(9.0)), testing::ElementsAre(0.3));
}

TEST(ImuFeedTest, CountsByTheClockOfTheSensor) {
  ImuFeed feed(5.0);
  for (int k = 0; k <= 6; ++k) feed.Add(At(5.0 + k / 20.0));
  EXPECT_TRUE(feed.Covers(0.1));
  EXPECT_FALSE(feed.Covers(0.16));
  EXPECT_EQ(feed.Take(0.049).size(), 5u);
}

TEST(ImuFeedTest, LeavesOutWhatDriversSendTwice) {
  ImuFeed feed;
  EXPECT_FALSE(feed.Covers(-9.0));
  for (const double stamp : {1.0, 1.01, 1.01, 1.005, 1.02}) feed.Add(At(stamp));
  feed.Add(At(std::nan("")));
  ImuSample broken = At(1.03);
  broken.accel.x() = INFINITY;
  feed.Add(broken);
  EXPECT_THAT(StampsOf(feed.Take(2.0)), testing::ElementsAre(1.0, 1.01, 1.02));
  feed.Add(At(1.02));
  EXPECT_THAT(feed.Take(2.0), testing::IsEmpty());
  EXPECT_THAT(feed.Remark("/imu"), testing::HasSubstr("/imu: left out 5 "));
  EXPECT_EQ(ImuFeed().Remark("/imu"), "");
}

}  // namespace
}  // namespace rgbd_pose
