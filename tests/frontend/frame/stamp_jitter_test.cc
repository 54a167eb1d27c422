#include "frontend/frame/stamp_jitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rgbd_pose {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // s

// Delays that start at 3 ms, grow by `drift` (s) each frame and wrap around.
double SigmaOf(double drift, double jitter, int frames) {
  std::mt19937 random(1);
  std::normal_distribution<double> error(0.0, jitter);
  StampJitter stamps;
  for (int i = 0; i < frames; ++i) {
    const double even = 3e-3 + i * drift;
    const double wrapped = even - kInterval * std::round(even / kInterval);
    stamps.Add(wrapped + (jitter > 0.0 ? error(random) : 0.0), kInterval);
  }
  return stamps.sigma();
}

TEST(StampJitterTest, EvenDelaysHaveNone) {
  EXPECT_EQ(SigmaOf(0.0, 0.0, 100), 0.0);
  EXPECT_LT(SigmaOf(2e-3, 0.0, 100), 1e-12);  // two rates, with jumps
}

TEST(StampJitterTest, FindsTheScatterOfStamps) {
  for (const double jitter : {0.1e-3, 0.5e-3, 2e-3}) {
    for (const double drift : {0.0, 1e-3}) {
      // Of 30 numbers, three of which belong together.
      EXPECT_NEAR(SigmaOf(drift, jitter, 100), jitter, 0.4 * jitter);
    }
  }
}

TEST(StampJitterTest, IsNotKnownAtTheStart) {
  EXPECT_EQ(SigmaOf(0.0, 1e-3, 6), 0.0);
  EXPECT_GT(SigmaOf(0.0, 1e-3, 7), 0.0);
}

}  // namespace
}  // namespace rgbd_pose
