#include "core/util/counter_random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

namespace rgbd_pose {
namespace {

// The numbers are the same on every platform.
TEST(CounterRandomTest, KnowsItsNumbers) {
  CounterRandom random(0);
  // SplitMix64 of seed 0, as published with the generator.
  EXPECT_EQ(random.Next(), 0xe220a8397b1dcdafu);
  EXPECT_EQ(random.Next(), 0x6e789e6aa1b965f4u);
}

TEST(CounterRandomTest, DrawsEvenlyBelowTheEnd) {
  constexpr int kDraws = 70000;
  int count[7] = {};
  CounterRandom random(42);
  for (int i = 0; i < kDraws; ++i) {
    const uint32_t number = random.Below(7);
    ASSERT_LT(number, 7U);
    ++count[number];
  }
  // 10000 each, with a standard deviation of 93.
  for (const int c : count) EXPECT_NEAR(c, 10000, 500);
}

// All 60 ordered triples out of five numbers, equally often.
TEST(CounterRandomTest, DrawsThreeDifferentNumbers) {
  constexpr int kDraws = 60000;
  std::map<std::array<uint32_t, 3>, int> count;
  CounterRandom random(43);
  for (int i = 0; i < kDraws; ++i) ++count[random.ThreeBelow(5)];
  EXPECT_EQ(count.size(), 60U);
  for (const auto& [three, c] : count) {
    EXPECT_LT(*std::max_element(three.begin(), three.end()), 5U);
    EXPECT_TRUE(three[0] != three[1] && three[0] != three[2] &&
                three[1] != three[2]);
    EXPECT_NEAR(c, 1000, 160);  // the standard deviation is 32
  }
}

}  // namespace
}  // namespace rgbd_pose
