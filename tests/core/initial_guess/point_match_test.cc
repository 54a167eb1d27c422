#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/initial_guess/consensus.h"
#include "core/util/quantile.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

TEST(PointMatchTest, TakesMatchesWithDepthOnBothSides) {
  RandomWorld world(31);
  const Correspondences all = world.Matches(4, 0.0, Rigid3d());
  Correspondences matches(all.camera());
  Observation blind = all[0].cur;
  blind.depth = 0.0;
  matches.Add(all[0].prev, blind);
  matches.Add(all[1].prev, all[1].cur);
  matches.Add(blind, all[2].cur);
  matches.Add(all[3].prev, all[3].cur);
  const std::vector<PointMatch> points = PointMatches(matches, 10);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].index, 1);
  EXPECT_EQ(points[1].index, 3);
  EXPECT_EQ(points[1].cur.position, matches.Point(all[3].cur));
}

TEST(PointMatchTest, SpreadsTheMostItTakesOverTheList) {
  RandomWorld world(32);
  const Correspondences matches = world.Matches(1000, 0.0, Rigid3d());
  for (const size_t most : {3U, 7U, 333U, 999U, 1000U, 5000U}) {
    const std::vector<PointMatch> points = PointMatches(matches, most);
    const size_t count = std::min<size_t>(most, 1000);
    ASSERT_EQ(points.size(), count);
    for (size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(points[i].index + 1.0, 1000.0 * (i + 1) / count, 1.0);
    }
  }
  EXPECT_TRUE(PointMatches(Correspondences(), 10).empty());
}

// Compares with the covariance of points computed from noisy measurements.
TEST(PointMatchTest, KnowsTheNoiseOfAPoint) {
  RandomWorld world(33);
  constexpr int kSamples = 20000;  // the variance is then accurate to 1 %
  const Camera camera;
  for (int trial = 0; trial < 3; ++trial) {
    Observation prev, cur;
    world.Match(camera, Rigid3d(), &prev, &cur);
    Correspondences matches(camera);
    matches.Add(prev, cur);
    const NoisyPoint point = PointMatches(matches, 1)[0].prev;
    const Eigen::Vector3d direction = world.Vector(1.0);
    double along = 0.0, total = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      Observation noisy = prev;
      world.AddNoise(&noisy);
      const Eigen::Vector3d error = matches.Point(noisy) - point.position;
      along += std::pow(error.dot(direction), 2) / kSamples;
      total += error.squaredNorm() / kSamples;
    }
    EXPECT_NEAR(point.VarianceAlong(direction) / along, 1.0, 0.05);
    EXPECT_NEAR(point.TotalVariance() / total, 1.0, 0.05);
  }
}

// Shares of 2000 right matches below the quantiles of chi^2.
struct Shares {
  double below_99;
  double below_median;
};

Shares MeasureShares(const Rigid3d& truth, RandomWorld* world) {
  constexpr int kMatches = 2000;
  Shares shares{0.0, 0.0};
  for (const PointMatch& point :
       PointMatches(world->Matches(kMatches, 0.0, truth), kMatches)) {
    const double distance = point.SquaredDistance(
        truth.rotation.toRotationMatrix(), truth.translation);
    if (distance <= ChiSquared99(3)) shares.below_99 += 1.0 / kMatches;
    if (distance <= ChiSquaredMedian(3)) shares.below_median += 1.0 / kMatches;
  }
  return shares;
}

// One sigma of the shares is 0.002 and 0.011.
TEST(PointMatchTest, DistancesFollowChiSquared) {
  for (int seed = 0; seed < 10; ++seed) {
    RandomWorld world(400 + seed);
    const Shares shares = MeasureShares(world.Motion(0.6, 0.1), &world);
    EXPECT_NEAR(shares.below_99, 0.99, 0.01) << seed;
    EXPECT_NEAR(shares.below_median, 0.5, 0.05) << seed;
  }
}

// Parallax, which the whitening ignores, loses 7 % of the matches at most.
TEST(PointMatchTest, DistancesBearParallax) {
  for (int seed = 0; seed < 10; ++seed) {
    RandomWorld world(400 + seed);
    const Shares shares = MeasureShares(world.Motion(0.6, 0.5), &world);
    EXPECT_GE(shares.below_99, 0.9) << seed;
    EXPECT_GE(shares.below_median, 0.38) << seed;
  }
}

// The change of a right pair's distance is normal: 95.4 % are within 2 sigma.
TEST(PointMatchTest, RightPairsPreserveTheirDistance) {
  RandomWorld world(34);
  const std::vector<PointMatch> points =
      PointMatches(world.Matches(400, 0.0, world.Motion(0.6, 0.5)), 400);
  int preserved = 0, pairs = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      preserved += AreDistanceConsistent(points[i], points[j], 2.0);
      ++pairs;
    }
  }
  // Pairs share points: 400 independent ones, hence 1 % at one sigma.
  EXPECT_NEAR(static_cast<double>(preserved) / pairs, 0.954, 0.02);
}

TEST(PointMatchTest, WrongPairsSeldomPreserveTheirDistance) {
  RandomWorld world(35);
  const std::vector<PointMatch> points =
      PointMatches(world.Matches(200, 1.0, Rigid3d()), 200);
  int preserved = 0, pairs = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      preserved += AreDistanceConsistent(points[i], points[j], 3.0);
      ++pairs;
    }
  }
  // Differences are spread over metres; 3 sigma are about 5 cm.
  EXPECT_LE(preserved, 0.1 * pairs);
}

TEST(PointMatchTest, AMatchIsConsistentWithItself) {
  RandomWorld world(36);
  const PointMatch point =
      PointMatches(world.Matches(1, 0.0, Rigid3d()), 1).at(0);
  EXPECT_TRUE(AreDistanceConsistent(point, point, 3.0));
}

}  // namespace
}  // namespace rgbd_pose
