#include "core/evaluation/association.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

using testing::ElementsAre;

using Pairs = std::vector<std::pair<int, int>>;

Pairs AssociateToPairs(const std::vector<double>& first,
                       const std::vector<double>& second,
                       double max_difference) {
  Pairs pairs;
  for (const auto& [i, j] : Associate(first, second, max_difference)) {
    pairs.emplace_back(i, j);
  }
  return pairs;
}

// A direct implementation of the definition: all pairs, the best first.
Pairs AssociateByDefinition(const std::vector<double>& first,
                            const std::vector<double>& second,
                            double max_difference) {
  std::vector<std::tuple<double, int, int>> candidates;
  for (size_t i = 0; i < first.size(); ++i) {
    for (size_t j = 0; j < second.size(); ++j) {
      const double difference = std::abs(first[i] - second[j]);
      if (difference <= max_difference)
        candidates.emplace_back(difference, i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> first_used(first.size());
  std::vector<bool> second_used(second.size());
  Pairs pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (first_used[i] || second_used[j]) continue;
    first_used[i] = second_used[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(AssociationTest, PairsTheNearestThatAreNearEnough) {
  const struct {
    const char* what;
    std::vector<double> first, second;
    double max_difference;
    Pairs pairs;
  } kCases[] = {
      {"nearest times",
       {1.00, 1.10, 1.20},
       {1.01, 1.095, 1.19},
       0.02,
       {{0, 0}, {1, 1}, {2, 2}}},
      {"too far apart", {1.0, 2.0, 3.0}, {1.021, 2.019, 5.0}, 0.02, {{1, 1}}},
      {"as far apart as allowed", {1.0}, {1.25}, 0.25, {{0, 0}}},
      {"equal, as is needed", {1.0}, {1.0}, 0.0, {{0, 0}}},
      {"1.015 is nearer to 1.012", {1.000, 1.015}, {1.012}, 0.02, {{1, 0}}},
      {"the same in turn", {1.012}, {1.000, 1.015}, 0.02, {{0, 1}}},
      {"what is left around a pair",
       {1.000, 1.007},
       {1.006, 1.012},
       0.02,
       {{0, 1}, {1, 0}}},
      {"the earlier of equal ones", {1.0}, {0.75, 1.25}, 0.5, {{0, 0}}},
      {"the same in turn", {0.75, 1.25}, {1.0}, 0.5, {{0, 0}}},
      {"nothing", {}, {}, 0.02, {}},
      {"nothing to pair with", {1.0}, {}, 0.02, {}},
      {"nothing to be paired", {}, {1.0}, 0.02, {}}};
  for (const auto& c : kCases) {
    EXPECT_EQ(AssociateToPairs(c.first, c.second, c.max_difference), c.pairs)
        << c.what;
  }
}

// Times on a coarse grid, which makes equal times and differences common.
TEST(AssociationTest, DoesAsTheDefinitionForRandomLists) {
  std::mt19937 random(7);
  const auto make_list = [&random] {
    std::vector<double> times;
    double time = 100.0;
    for (int i = 0; i < 60; ++i) {
      time += (1 + random() % 12) / 256.0;
      times.push_back(time);
    }
    return times;
  };
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<double> first = make_list();
    const std::vector<double> second = make_list();
    const double max_difference = (random() % 16) / 256.0;
    ASSERT_EQ(AssociateToPairs(first, second, max_difference),
              AssociateByDefinition(first, second, max_difference))
        << "trial " << trial;
  }
}

// Each entry is within the allowed difference of all others: 10^10 pairs.
TEST(AssociationTest, IsFastForEntriesThatAreAllClose) {
  constexpr int kCount = 100000;
  constexpr double kTimeLimit = 10.0;  // s; takes 0.1 s, all pairs minutes
  std::vector<double> times(kCount);
  for (int i = 0; i < kCount; ++i) times[i] = i * 1e-7;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(Associate(times, times, /*max_difference=*/0.02).size(),
            times.size());
  const std::chrono::duration<double> taken =
      std::chrono::steady_clock::now() - start;
  EXPECT_LT(taken.count(), kTimeLimit);
}

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

// As Associate pairs their times, in time order.
TEST(PosePairsTest, PairsTheNearestThatAreNearEnough) {
  EXPECT_THAT(PairTimes({0.0, 0.1, 0.2, 5.0}, {-0.015, 0.004, 0.125, 0.19}),
              ElementsAre(TimePair(0.0, 0.004), TimePair(0.2, 0.19)));
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
