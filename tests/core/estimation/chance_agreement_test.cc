#include "core/estimation/chance_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rgbd_pose {
namespace {

using Agreements = std::vector<MatchAgreement>;

Agreements Repeated(int count, double width, int rows) {
  return Agreements(count, {width, rows});
}

Agreements operator+(Agreements a, const Agreements& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

double AlarmsOf(Agreements agreements, double limit = 1.0, int parameters = 6) {
  return FalseAlarms(limit, parameters, &agreements);
}

// Six rows fit some motion exactly, however wrong they are.
TEST(FalseAlarmsTest, WhatSixRowsFitIsNotConfirmed) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(AlarmsOf({}), infinity);
  EXPECT_EQ(AlarmsOf(Repeated(6, 0.5, 1)), infinity);
  EXPECT_EQ(AlarmsOf(Repeated(3, 0.5, 2)), infinity);
  EXPECT_EQ(AlarmsOf(Repeated(2, 0.5, 3)), infinity);
  EXPECT_LT(AlarmsOf(Repeated(3, 0.5, 3)), 0.1);
}

TEST(FalseAlarmsTest, FollowsItsFormula) {
  // Four of five matches of two rows, one wrong at 14 limits.
  const Agreements some = Repeated(4, 0.5, 2) + Repeated(1, 14.0, 2);
  const double extent = 14.0 * std::sqrt(2.0);
  EXPECT_NEAR(AlarmsOf(some), (5 - 3) * 5.0 * 4.0 * std::pow(0.5 / extent, 2),
              1e-12);
}

// Where a prior says how the camera turned, three rows fit any motion.
TEST(FalseAlarmsTest, FewerParametersNeedFewerMatches) {
  EXPECT_EQ(AlarmsOf(Repeated(3, 0.5, 1), 1.0, 3),
            std::numeric_limits<double>::infinity());
  EXPECT_NEAR(AlarmsOf(Repeated(5, 0.5, 1), 1.0, 3),
              (5 - 3) * 10.0 * std::pow(0.5 / 10.0, 2), 1e-12);
}

// With a wide scale a few of many wrong matches agree, but few of them well.
TEST(FalseAlarmsTest, ManyWrongMatchesAgreeByChance) {
  const Agreements wrong =
      Repeated(6, 0.3, 1) + Repeated(4, 15.0, 1) + Repeated(10, 40.0, 1);
  EXPECT_GT(AlarmsOf(wrong, 20.0), 1.0);
  EXPECT_LT(AlarmsOf(Repeated(14, 0.9, 1) + Repeated(6, 40.0, 1)), 1e-3);
  EXPECT_LT(AlarmsOf(Repeated(40, 0.9, 3) + Repeated(60, 40.0, 3)), 1e-9);
}

// A match with fewer rows than others may not confirm more than these.
TEST(FalseAlarmsTest, TheFewestRowsCount) {
  EXPECT_EQ(AlarmsOf(Repeated(5, 0.5, 3) + Repeated(1, 0.5, 1)),
            AlarmsOf(Repeated(6, 0.5, 1)));
}

}  // namespace
}  // namespace rgbd_pose
