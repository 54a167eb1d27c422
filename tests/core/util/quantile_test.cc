#include "core/util/quantile.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

TEST(QuantileTest, LiesBetweenTwoValues) {
  const std::vector<double> values = {9.0, 1.0, 3.0, 5.0};
  EXPECT_DOUBLE_EQ(Quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(Quantile(values, 0.5), 4.0);
  EXPECT_DOUBLE_EQ(Quantile(values, 0.75), 6.0);
  EXPECT_DOUBLE_EQ(Quantile(values, 1.0), 9.0);
}

TEST(QuantileTest, MedianOfAnOddNumberIsOneOfThem) {
  EXPECT_DOUBLE_EQ(Median({7.0, -2.0, 4.0}), 4.0);
  EXPECT_DOUBLE_EQ(Median({7.0}), 7.0);
}

TEST(QuantileTest, NothingHasNone) { EXPECT_TRUE(std::isnan(Median({}))); }

}  // namespace
}  // namespace rgbd_pose
