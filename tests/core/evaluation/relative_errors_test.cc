#include "core/evaluation/relative_errors.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

// Rounding of quantiles of 0, 0.01, ... 1.00.
constexpr double kQuantileTolerance = 1e-12;

// Steps of the estimate grow from 0 to 1 m by 1 cm; steps of the truth are 0.
std::vector<PosePair> GrowingSteps() {
  std::vector<PosePair> pairs(102);
  for (size_t i = 1; i < pairs.size(); ++i) {
    pairs[i].estimate = pairs[i - 1].estimate;
    pairs[i].estimate.translation.x() += 0.01 * (i - 1);
  }
  return pairs;
}

RelativePoseError SummariseFrames(const std::vector<PosePair>& pairs,
                                  size_t frames) {
  return SummariseIntervals(pairs, FrameIntervals(pairs.size(), frames));
}

TEST(RelativeErrorsTest, QuantilesOverOneFrame) {
  const RelativePoseError error = SummariseFrames(GrowingSteps(), 1);
  EXPECT_EQ(error.translation.count, 101);
  EXPECT_EQ(error.rotation.count, 101);
  EXPECT_NEAR(error.translation.median, 0.5, kQuantileTolerance);
  EXPECT_NEAR(error.translation.p90, 0.9, kQuantileTolerance);
  EXPECT_NEAR(error.translation.p99, 0.99, kQuantileTolerance);
  EXPECT_EQ(error.rotation.p99, 0.0);
}

// From the i-th pose, two steps of i and i + 1 cm.
TEST(RelativeErrorsTest, QuantilesOverMoreFrames) {
  const RelativePoseError error = SummariseFrames(GrowingSteps(), 2);
  EXPECT_EQ(error.translation.count, 100);
  EXPECT_NEAR(error.translation.median, 0.01 * (2 * 49.5 + 1),
              kQuantileTolerance);
}

TEST(RelativeErrorsTest, NoneOverMoreFramesThanThereAre) {
  EXPECT_EQ(SummariseFrames(GrowingSteps(), 102).translation.count, 0);
  EXPECT_EQ(SummariseFrames(GrowingSteps(), 102).translation.p99, 0.0);
  EXPECT_EQ(SummariseFrames({}, 1).rotation.count, 0);
}

}  // namespace
}  // namespace rgbd_pose
