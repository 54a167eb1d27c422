// Tests for every consensus search, whichever method it uses.

#include "core/initial_guess/consensus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

struct Search {
  std::string name;
  std::optional<Consensus> (*find)(const Correspondences& matches);
};

class ConsensusTest : public ::testing::TestWithParam<Search> {
 protected:
  static std::optional<Consensus> Find(const Correspondences& matches) {
    return GetParam().find(matches);
  }
};

Rigid3d FarMotion(RandomWorld* world) { return world->Motion(0.6, 0.5); }

// Without noise, only rounding of 64-bit numbers remains: 1e-16 of 4 m over
// about ten operations.
TEST_P(ConsensusTest, IsExactWithoutNoise) {
  constexpr double kRounding = 1e-12;
  for (const double outliers : {0.0, 0.5}) {
    RandomWorld world(21);
    const Rigid3d truth = FarMotion(&world);
    const std::optional<Consensus> found =
        Find(world.Matches(100, outliers, truth, /*noise=*/false));
    ASSERT_TRUE(found.has_value());
    const MotionError error = ErrorOf(found->cur_from_prev, truth);
    EXPECT_LE(error.angle, kRounding);
    EXPECT_LE(error.translation, kRounding);
    EXPECT_EQ(found->inliers.size(), 100 * (1.0 - outliers));
  }
}

// The unit of error is the mean error of the trials without outliers, divided
// by sqrt(inlier share), because fewer matches average less noise. Measured
// over 200 trials: 1.07 units on average, 3.2 at most. A mean over 40 trials,
// and hence the unit, is accurate to 10 %.
TEST_P(ConsensusTest, SurvivesOutliers) {
  constexpr int kTrials = 40;
  constexpr int kMatches = 300;
  constexpr double kMeanUnits = 1.5;
  constexpr double kMostUnits = 4.0;
  double clean_angle = 0.0, clean_translation = 0.0;
  for (const double outliers : {0.0, 0.2, 0.4, 0.7}) {
    const double right = 1.0 - outliers;
    double angle = 0.0, translation = 0.0;
    for (int seed = 0; seed < kTrials; ++seed) {
      RandomWorld world(200 + seed);
      const Rigid3d truth = FarMotion(&world);
      const std::optional<Consensus> found =
          Find(world.Matches(kMatches, outliers, truth));
      ASSERT_TRUE(found.has_value()) << outliers << ", seed " << seed;
      const MotionError error = ErrorOf(found->cur_from_prev, truth);
      angle += error.angle / kTrials;
      translation += error.translation / kTrials;
      // 99 % of the right matches at best; another 10 % may be lost.
      EXPECT_GE(found->inliers.size(), 0.89 * right * kMatches);
      EXPECT_LE(found->inliers.size(), right * kMatches + 3);
      if (outliers == 0.0) continue;
      EXPECT_LE(error.angle, kMostUnits * clean_angle / std::sqrt(right));
      EXPECT_LE(error.translation,
                kMostUnits * clean_translation / std::sqrt(right));
    }
    if (outliers == 0.0) {
      clean_angle = angle;
      clean_translation = translation;
      // One match is accurate to about 5 mm and 5 mrad, 300 to far less.
      EXPECT_LE(angle, 1e-3);
      EXPECT_LE(translation, 2e-3);
    }
    EXPECT_LE(angle, kMeanUnits * clean_angle / std::sqrt(right)) << outliers;
    EXPECT_LE(translation, kMeanUnits * clean_translation / std::sqrt(right))
        << outliers;
  }
}

TEST_P(ConsensusTest, FindsTheSameBytesTwice) {
  RandomWorld world(22);
  const Correspondences matches = world.Matches(300, 0.5, FarMotion(&world));
  const std::optional<Consensus> first = Find(matches);
  const std::optional<Consensus> second = Find(matches);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->cur_from_prev.rotation.coeffs(),
            second->cur_from_prev.rotation.coeffs());
  EXPECT_EQ(first->cur_from_prev.translation,
            second->cur_from_prev.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST_P(ConsensusTest, FindsNothingInTooFewMatches) {
  for (const int count : {0, 1, 2, 3, 5}) {
    RandomWorld world(23);
    EXPECT_FALSE(Find(world.Matches(count, 0.0, Rigid3d())).has_value())
        << count << " matches";
  }
}

// All points on a line (along the image or on one ray), or all at one point.
TEST_P(ConsensusTest, FindsNothingOnALine) {
  const Camera camera;
  for (const bool noise : {false, true}) {
    for (const bool along_image : {true, false}) {
      for (const bool spot : {true, false}) {
        RandomWorld world(24);
        Correspondences matches(camera);
        for (int i = 0; i < 100; ++i) {
          Observation prev{camera.cx, camera.cy, 2.0, 0.5, 0.0057};
          if (!spot && along_image) prev.u = world.Uniform(0, 639);
          if (!spot && !along_image) prev.depth = world.Uniform(1.0, 4.0);
          Observation cur = prev;
          if (noise) {
            world.AddNoise(&prev);
            world.AddNoise(&cur);
          }
          matches.Add(prev, cur);
        }
        EXPECT_FALSE(Find(matches).has_value());
      }
    }
  }
}

TEST_P(ConsensusTest, FindsNothingInOutliersOnly) {
  for (int seed = 0; seed < 30; ++seed) {
    RandomWorld world(300 + seed);
    for (const int count : {10, 100, 300}) {
      EXPECT_FALSE(Find(world.Matches(count, 1.0, Rigid3d())).has_value())
          << count << " matches, seed " << seed;
    }
  }
}

// A mirrored scene keeps all distances, but no camera motion produces it.
TEST_P(ConsensusTest, FindsNoMirrorImage) {
  RandomWorld world(25);
  const Camera camera;
  Correspondences matches(camera);
  for (int i = 0; i < 200; ++i) {
    Observation prev, cur;
    world.Match(camera, Rigid3d(), &prev, &cur);
    cur.u = 2.0 * camera.cx - prev.u;
    matches.Add(prev, cur);
  }
  EXPECT_FALSE(Find(matches).has_value());
}

// Matches without depth, however wrong their pixels, only change the indices of
// the other matches.
TEST_P(ConsensusTest, IgnoresMatchesWithoutDepth) {
  RandomWorld world(26);
  const Correspondences matches = world.Matches(100, 0.3, FarMotion(&world));
  Correspondences mixed(matches.camera());
  for (size_t i = 0; i < matches.size(); ++i) {
    Observation blind = matches[i].cur;
    blind.u = world.Uniform(0.0, 639.0);
    blind.depth = 0.0;
    mixed.Add(i % 2 == 0 ? blind : matches[i].prev,
              i % 2 == 0 ? matches[i].cur : blind);
    mixed.Add(matches[i].prev, matches[i].cur);
  }
  const std::optional<Consensus> expected = Find(matches);
  const std::optional<Consensus> actual = Find(mixed);
  ASSERT_TRUE(expected && actual);
  EXPECT_EQ(actual->cur_from_prev.translation,
            expected->cur_from_prev.translation);
  std::vector<int> places = expected->inliers;
  for (int& place : places) place = 2 * place + 1;
  EXPECT_EQ(actual->inliers, places);
}

const Search kSearches[] = {
    {"ransac", [](const Correspondences& m) { return FindByRansac(m); }},
    {"clique", [](const Correspondences& m) { return FindByClique(m); }}};
INSTANTIATE_TEST_SUITE_P(All, ConsensusTest, ::testing::ValuesIn(kSearches),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace rgbd_pose
