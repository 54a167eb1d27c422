#include "apps/figures/chart_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rgbd_pose {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pointwise;

std::vector<double> ValuesOf(const std::vector<AxisTick>& ticks) {
  std::vector<double> values;
  for (const AxisTick& tick : ticks) values.push_back(tick.value);
  return values;
}

TEST(ChartAxisTest, ARangeHasRoomAroundItsValues) {
  const AxisRange range =
      RangeOf({2.0, std::nan(""), 12.0, std::log(0.0), 7.0});
  EXPECT_DOUBLE_EQ(range.low, 1.6);
  EXPECT_DOUBLE_EQ(range.high, 12.4);
}

TEST(ChartAxisTest, ARangeOfOneOrNoValueIsWide) {
  EXPECT_GT(RangeOf({}).span(), 0.0);
  EXPECT_GT(RangeOf({3.0}).span(), 0.0);
  EXPECT_EQ(RangeOf({3.0}).Share(3.0), 0.5);
}

TEST(ChartAxisTest, LinearTicsAreRoundNumbers) {
  EXPECT_THAT(ValuesOf(LinearTicks({-0.1, 1.01})),
              Pointwise(DoubleNear(1e-12), {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_THAT(
      ValuesOf(LinearTicks({-21.0, 39.0})),
      Pointwise(DoubleNear(1e-12), {-20.0, -10.0, 0.0, 10.0, 20.0, 30.0}));
}

TEST(ChartAxisTest, LogTicsGetFewerOnALongAxis) {
  EXPECT_THAT(ValuesOf(LogTicks({-0.5, 1.2})),
              Pointwise(DoubleNear(1e-12), {0.5, 1.0, 2.0, 5.0, 10.0}));
  EXPECT_THAT(ValuesOf(LogTicks({-0.5, 3.2})),
              Pointwise(DoubleNear(1e-12), {1.0, 10.0, 100.0, 1000.0}));
  for (const AxisTick& tick : LogTicks({-0.5, 1.2})) {
    EXPECT_DOUBLE_EQ(tick.place, std::log10(tick.value));
  }
}

}  // namespace
}  // namespace rgbd_pose
