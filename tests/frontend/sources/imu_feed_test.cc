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
  for (int k = 0; k <= 10; ++k) feed.Add(At(0.02 * k));
  EXPECT_TRUE(feed.Covers(0.1));
  EXPECT_FALSE(feed.Covers(0.16));
  // 0.03 s and kReach are 0.08 s, which is a sample.
  EXPECT_THAT(StampsOf(feed.Take(0.029)),
              testing::ElementsAre(0.0, 0.02, 0.04, 0.06, 0.08));
  EXPECT_THAT(StampsOf(feed.Take(0.06)), testing::ElementsAre(0.1, 0.12));
  EXPECT_THAT(feed.Take(0.06), testing::IsEmpty());
  EXPECT_THAT(StampsOf(feed.Take(9.0)),
              testing::ElementsAre(0.14, 0.16, 0.18, 0.2));
}

TEST(ImuFeedTest, CountsByTheClockOfTheSensor) {
  ImuFeed feed(5.0);
  for (int k = 0; k <= 10; ++k) feed.Add(At(5.0 + 0.02 * k));
  EXPECT_TRUE(feed.Covers(0.1));
  EXPECT_FALSE(feed.Covers(0.16));
  EXPECT_EQ(feed.Take(0.029).size(), 5u);
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
