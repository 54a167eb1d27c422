#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "apps/compare/compare_sweep.h"

namespace rgbd_pose {
namespace {

TEST(CompareStatisticsTest, RanksAreThoseOfTables) {
  // As in the tables of David & Nagaraja: the 40th and 61st of 100 values, the
  // 2nd and 9th of 10, the extremes of 6. Ranks count from 0.
  EXPECT_EQ(MedianBandRank(100), 39);
  EXPECT_EQ(MedianBandRank(10), 1);
  EXPECT_EQ(MedianBandRank(6), 0);
  EXPECT_EQ(MedianBandRank(1), 0);
}

TEST(CompareStatisticsTest, BandOfKnownValues) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const MedianBand band = FindMedianBand(values);
  EXPECT_EQ(band.median, 50.5);
  EXPECT_EQ(band.low, 40.0);
  EXPECT_EQ(band.high, 61.0);
  EXPECT_EQ(band.p90, 90.0);
  EXPECT_TRUE(std::isnan(FindMedianBand({}).median));
}

TEST(CompareStatisticsTest, BandHoldsTheMedianAsOftenAsItSays) {
  std::mt19937 generator(1);
  const int trials = 2000;
  int held = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> values;
    for (int i = 0; i < 50; ++i) values.push_back(generator() / 4294967296.0);
    const MedianBand band = FindMedianBand(values);
    held += band.low <= 0.5 && 0.5 <= band.high;
  }
  // Binomial distribution: 96.7 %; 2000 trials have a sigma of 0.4 %.
  EXPECT_NEAR(held / static_cast<double>(trials), 0.967, 0.016);
}

}  // namespace
}  // namespace rgbd_pose
