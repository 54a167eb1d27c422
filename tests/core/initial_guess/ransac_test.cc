#include "core/initial_guess/ransac.h"

#include <gtest/gtest.h>

#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

// What all searches have in common is in consensus_test.cc.

TEST(RansacTest, SeedsDrawOtherSamplesAndFindTheSame) {
  RandomWorld world(41);
  const Rigid3d truth = world.Motion(0.6, 0.5);
  const Correspondences matches = world.Matches(300, 0.5, truth);
  for (uint64_t seed = 0; seed < 30; ++seed) {
    RansacOptions options;
    options.seed = seed;
    const auto found = FindByRansac(matches, options);
    ASSERT_TRUE(found.has_value()) << seed;
    // The mean error is 1.2 mm and 0.6 mrad.
    EXPECT_LE(ErrorOf(found->cur_from_prev, truth).translation, 0.006);
    EXPECT_LE(ErrorOf(found->cur_from_prev, truth).angle, 0.003);
  }
}

// One sample is enough without outliers, never with 70 % of them.
TEST(RansacTest, MoreSamplesSurviveMoreOutliers) {
  RansacOptions options;
  options.max_samples = 3;
  int found_clean = 0, found_dirty = 0;
  constexpr int kTrials = 30;
  for (int seed = 0; seed < kTrials; ++seed) {
    RandomWorld world(500 + seed);
    const Rigid3d truth = world.Motion(0.6, 0.5);
    found_clean +=
        FindByRansac(world.Matches(300, 0.0, truth), options).has_value();
    found_dirty +=
        FindByRansac(world.Matches(300, 0.7, truth), options).has_value();
  }
  EXPECT_EQ(found_clean, kTrials);
  // 0.3^3 = 2.7 % of samples are right: 2.4 of 30 trials on average.
  EXPECT_LE(found_dirty, 8);
}

TEST(RansacTest, SaysWhichOptionIsWrong) {
  const Correspondences none;
  const auto expect_error = [&](RansacOptions options, const char* name) {
    ExpectInputError([&] { FindByRansac(none, options); }, {name});
  };
  RansacOptions options;
  options.max_samples = 0;
  expect_error(options, "max_samples");
  options = {};
  options.confidence = 1.0;
  expect_error(options, "confidence");
  options = {};
  options.max_distance_sigmas = 0.0;
  expect_error(options, "max_distance_sigmas");
  options = {};
  options.max_matches = 2;
  expect_error(options, "max_matches");
  options = {};
  options.consensus.min_inliers = 0;
  expect_error(options, "min_inliers");
}

}  // namespace
}  // namespace rgbd_pose
