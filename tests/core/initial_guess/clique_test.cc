#include <gtest/gtest.h>

#include "core/initial_guess/consensus.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

// Tests that apply to all searches are in consensus_test.cc.

// Two rigid bodies, each of which is a clique: the larger one is found,
// whichever comes first.
TEST(CliqueTest, FindsTheLargerOfTwoBodies) {
  for (const bool larger_first : {true, false}) {
    RandomWorld world(51);
    const Rigid3d larger = world.Motion(0.3, 0.3);
    const Rigid3d smaller = world.Motion(0.3, 0.3);
    Correspondences matches;
    for (int i = 0; i < 200; ++i) {
      const bool is_first = i < (larger_first ? 120 : 80);
      Observation prev, cur;
      world.Match(matches.camera(), is_first == larger_first ? larger : smaller,
                  &prev, &cur);
      world.AddNoise(&prev);
      world.AddNoise(&cur);
      matches.Add(prev, cur);
    }
    const auto found = FindByClique(matches);
    ASSERT_TRUE(found.has_value());
    // 120 matches: 2 mm on average.
    EXPECT_LE(ErrorOf(found->cur_from_prev, larger).translation, 0.01);
    for (const int inlier : found->inliers) {
      EXPECT_TRUE(larger_first ? inlier < 120 : inlier >= 80) << inlier;
    }
  }
}

// Far more matches than the search uses.
TEST(CliqueTest, LooksAtTheMostItMay) {
  RandomWorld world(52);
  const Rigid3d truth = world.Motion(0.6, 0.5);
  const auto found = FindByClique(world.Matches(20000, 0.4, truth));
  ASSERT_TRUE(found.has_value());
  EXPECT_LE(found->inliers.size(), 310U);
  EXPECT_GE(found->inliers.size(), 280U);
  EXPECT_LE(ErrorOf(found->cur_from_prev, truth).translation, 0.01);
}

// Sizes at which a row of bits just fills its last word, or just does not.
TEST(CliqueTest, FillsItsWords) {
  for (const int count : {63, 64, 65, 128, 129}) {
    RandomWorld world(53);
    const auto found = FindByClique(
        world.Matches(count, 0.0, world.Motion(0.6, 0.5), /*noise=*/false));
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->inliers.size(), static_cast<size_t>(count));
  }
}

}  // namespace
}  // namespace rgbd_pose
