#include "frontend/slam/sequence_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace rgbd_pose {
namespace {

TEST(ResidualHistogram, CountsMatchesThatSomeCostCouldUse) {
  MotionEstimate estimate;
  estimate.residual_norms = {0.0, 0.05, 7.95, 8.05, 1e300, 0.0};
  estimate.residual_degrees = {3, 3, 2, 3, 3, 0};
  estimate.weights = {1.0, 0.97, 0.5, 0.0, 0.0, 0.0};
  ResidualHistogram histogram;
  histogram.Add(estimate);
  histogram.Add(estimate);
  EXPECT_EQ(histogram.matches, 10);
  const auto& norms = histogram.norms;
  EXPECT_EQ(norms.front(), 4);
  EXPECT_EQ(norms.back(), 2);
  EXPECT_EQ(std::accumulate(norms.begin(), norms.end(), int64_t{0}), 6);
  EXPECT_EQ(histogram.norms_above, 4);
  EXPECT_EQ(histogram.weights.front(), 4);
  EXPECT_EQ(histogram.weights[10], 2);
  EXPECT_EQ(histogram.weights.back(), 4);
  EXPECT_EQ(histogram.weights_zero, 4);
  EXPECT_THAT(histogram.degrees, testing::ElementsAre(0, 0, 2, 8, 0, 0, 0));
}

}  // namespace
}  // namespace rgbd_pose
