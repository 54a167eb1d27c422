#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/evaluation/association.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;

constexpr double kMaxTimeDifference = 0.02;

// Poses whose x is their time, which identifies them in pairs.
Trajectory At(const std::vector<double>& times) {
  Trajectory trajectory;
  for (const double time : times) {
    trajectory.push_back(
        {time, {Eigen::Quaterniond::Identity(), {time, 0.0, 0.0}}});
  }
  return trajectory;
}

// Time stamps of the paired estimates and of their ground truth.
using TimePair = std::pair<double, double>;
std::vector<TimePair> PairTimes(const std::vector<double>& estimate,
                                const std::vector<double>& truth) {
  std::vector<TimePair> times;
  for (const PosePair& pair :
       PairPoses(At(estimate), At(truth), kMaxTimeDifference)) {
    EXPECT_EQ(pair.timestamp, pair.estimate.translation.x());
    times.emplace_back(pair.estimate.translation.x(),
                       pair.truth.translation.x());
  }
  return times;
}

TEST(PosePairsTest, NearestTimePrefersTheEarlierOfTwo) {
  const std::vector<double> times = {1.0, 2.0, 4.0};
  const TimePair kCases[] = {{-5.0, 0}, {1.0, 0}, {1.5, 0}, {1.6, 1},
                             {2.9, 1},  {3.0, 1}, {3.1, 2}, {9.0, 2}};
  for (const auto& [time, expected] : kCases) {
    EXPECT_EQ(NearestTime(times, time), expected) << time;
  }
  EXPECT_EQ(NearestTime({1.0}, 7.0), 0u);
}

TEST(PosePairsTest, PairsTheNearest) {
  EXPECT_THAT(PairTimes({0.0, 0.1, 0.2}, {-0.015, 0.004, 0.105, 0.19}),
              ElementsAre(TimePair(0.0, 0.004), TimePair(0.1, 0.105),
                          TimePair(0.2, 0.19)));
}

TEST(PosePairsTest, LeavesOutWhatIsTooFar) {
  EXPECT_THAT(PairTimes({0.0, 0.1, 0.2, 5.0}, {0.0, 0.125, 0.215}),
              ElementsAre(TimePair(0.0, 0.0), TimePair(0.2, 0.215)));
}

TEST(PosePairsTest, UsesEachPoseOnceWhicheverRateIsHigher) {
  std::vector<double> slow, fast;
  std::vector<TimePair> slow_to_fast;
  for (int i = 0; i < 300; ++i) {
    fast.push_back(0.01 * i);
    if (i % 4 == 0) {
      slow.push_back(0.01 * i + 0.003);
      slow_to_fast.emplace_back(slow.back(), fast.back());
    }
  }
  EXPECT_EQ(PairTimes(slow, fast), slow_to_fast);
  std::vector<TimePair> fast_to_slow;
  for (const auto& [a, b] : slow_to_fast) fast_to_slow.emplace_back(b, a);
  EXPECT_EQ(PairTimes(fast, slow), fast_to_slow);
}

TEST(PosePairsTest, NamesTheTimeRangesIfThereIsNoPair) {
  ExpectInputError(
      [] {
        PairTimes({1.0, 2.0}, {1311868164.25, 1311868165.5});
      },
      {"1.000000 s to 2.000000 s", "0.02 s",
       "1311868164.250000 s to 1311868165.500000 s"});
  ExpectInputError([] { PairTimes({}, {1.0}); }, {"estimate (no poses)"});
  ExpectInputError([] { PairTimes({1.0}, {}); }, {"truth (no poses)"});
}

}  // namespace
}  // namespace rgbd_pose
