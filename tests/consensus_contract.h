#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/consensus.h"
#include "core/correspondences.h"
#include "tests/motion_error.h"
#include "tests/random_motion.h"

// What every search for a consensus has to do, whichever way it searches.

namespace rgbd_pose {

using ConsensusSearch =
    std::function<std::optional<Consensus>(const Correspondences&)>;

// Motions that no guess of "no motion" comes near.
inline Rigid3d FarMotion(RandomWorld* world) { return world->Motion(0.6, 0.5); }

// Where the only noise is that of 64-bit numbers: 1e-16 of 4 m, some ten
// operations long.
inline void ExpectExactWithoutNoise(const ConsensusSearch& find) {
  constexpr double kRounding = 1e-12;
  for (const double outliers : {0.0, 0.5}) {
    RandomWorld world(21);
    const Rigid3d truth = FarMotion(&world);
    const std::optional<Consensus> found =
        find(world.Matches(100, outliers, truth, /*noise=*/false));
    ASSERT_TRUE(found.has_value());
    const MotionError error = ErrorOf(found->cur_from_prev, truth);
    EXPECT_LE(error.angle, kRounding);
    EXPECT_LE(error.translation, kRounding);
    EXPECT_EQ(found->inliers.size(), 100 * (1.0 - outliers));
  }
}

// The unit of error is the mean of trials without a wrong match, times
// 1 / sqrt(share of right matches): fewer matches are not averaged as well.
// Right matches whose noise is beyond the limit go, wrong ones that are right
// by chance stay: 1.3 units on average. The error of one trial, three numbers
// of mean size about 1, exceeds 4 units less than once in a million.
inline void ExpectSurvivesOutliers(const ConsensusSearch& find) {
  constexpr int kTrials = 40;
  constexpr int kMatches = 300;
  double clean_angle = 0.0, clean_translation = 0.0;
  for (const double outliers : {0.0, 0.2, 0.4, 0.7}) {
    const double right = 1.0 - outliers;
    double angle = 0.0, translation = 0.0;
    for (int seed = 0; seed < kTrials; ++seed) {
      RandomWorld world(200 + seed);
      const Rigid3d truth = FarMotion(&world);
      const std::optional<Consensus> found =
          find(world.Matches(kMatches, outliers, truth));
      ASSERT_TRUE(found.has_value()) << outliers << ", seed " << seed;
      const MotionError error = ErrorOf(found->cur_from_prev, truth);
      angle += error.angle / kTrials;
      translation += error.translation / kTrials;
      // 99 % of the right ones at best; a tenth more may be lost.
      EXPECT_GE(found->inliers.size(), 0.89 * right * kMatches);
      EXPECT_LE(found->inliers.size(), right * kMatches + 3);
      if (outliers == 0.0) continue;
      EXPECT_LE(error.angle, 4.0 * clean_angle / std::sqrt(right));
      EXPECT_LE(error.translation, 4.0 * clean_translation / std::sqrt(right));
    }
    if (outliers == 0.0) {
      clean_angle = angle;
      clean_translation = translation;
      // One match is good to some 5 mm and 5 mrad, 300 to much less.
      EXPECT_LE(angle, 1e-3);
      EXPECT_LE(translation, 2e-3);
    }
    EXPECT_LE(angle, 1.3 * clean_angle / std::sqrt(right)) << outliers;
    EXPECT_LE(translation, 1.3 * clean_translation / std::sqrt(right))
        << outliers;
  }
}

inline void ExpectSameTwice(const ConsensusSearch& find) {
  RandomWorld world(22);
  const Correspondences matches = world.Matches(300, 0.5, FarMotion(&world));
  const std::optional<Consensus> first = find(matches);
  const std::optional<Consensus> second = find(matches);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->cur_from_prev.rotation.coeffs(),
            second->cur_from_prev.rotation.coeffs());
  EXPECT_EQ(first->cur_from_prev.translation,
            second->cur_from_prev.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

inline void ExpectNothingFromTooFew(const ConsensusSearch& find) {
  for (const int count : {0, 1, 2, 3, 5}) {
    RandomWorld world(23);
    EXPECT_FALSE(find(world.Matches(count, 0.0, Rigid3d())).has_value())
        << count << " matches";
  }
}

// All points on a line: along the image, or on one ray; or all in one spot.
inline void ExpectNothingFromALine(const ConsensusSearch& find) {
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
        EXPECT_FALSE(find(matches).has_value());
      }
    }
  }
}

inline void ExpectNothingFromOutliersOnly(const ConsensusSearch& find) {
  for (int seed = 0; seed < 30; ++seed) {
    RandomWorld world(300 + seed);
    for (const int count : {10, 100, 300}) {
      EXPECT_FALSE(find(world.Matches(count, 1.0, Rigid3d())).has_value())
          << count << " matches, seed " << seed;
    }
  }
}

// A mirrored scene keeps all its distances, but no motion of a camera makes it.
inline void ExpectNothingFromAMirror(const ConsensusSearch& find) {
  RandomWorld world(25);
  const Camera camera;
  Correspondences matches(camera);
  for (int i = 0; i < 200; ++i) {
    Observation prev, cur;
    world.Match(camera, Rigid3d(), &prev, &cur);
    cur.u = 2.0 * camera.cx - prev.u;
    matches.Add(prev, cur);
  }
  EXPECT_FALSE(find(matches).has_value());
}

// Matches without a depth, however wrong their pixels, change nothing but the
// places of the others.
inline void ExpectIgnoresMatchesWithoutDepth(const ConsensusSearch& find) {
  RandomWorld world(26);
  const Correspondences matches = world.Matches(100, 0.3, FarMotion(&world));
  Correspondences mixed(matches.camera());
  for (size_t i = 0; i < matches.size(); ++i) {
    Observation blind = matches.cur()[i];
    blind.u = world.Uniform(0.0, 639.0);
    blind.depth = 0.0;
    mixed.Add(i % 2 == 0 ? blind : matches.prev()[i],
              i % 2 == 0 ? matches.cur()[i] : blind);
    mixed.Add(matches.prev()[i], matches.cur()[i]);
  }
  const std::optional<Consensus> expected = find(matches);
  const std::optional<Consensus> actual = find(mixed);
  ASSERT_TRUE(expected && actual);
  EXPECT_EQ(actual->cur_from_prev.translation,
            expected->cur_from_prev.translation);
  std::vector<int> places = expected->inliers;
  for (int& place : places) place = 2 * place + 1;
  EXPECT_EQ(actual->inliers, places);
}

inline void ExpectContract(const ConsensusSearch& find) {
  ExpectExactWithoutNoise(find);
  ExpectSurvivesOutliers(find);
  ExpectSameTwice(find);
  ExpectNothingFromTooFew(find);
  ExpectNothingFromALine(find);
  ExpectNothingFromOutliersOnly(find);
  ExpectNothingFromAMirror(find);
  ExpectIgnoresMatchesWithoutDepth(find);
}

}  // namespace rgbd_pose
