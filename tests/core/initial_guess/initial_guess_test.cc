#include "core/initial_guess/initial_guess.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "core/estimation/estimator.h"
#include "core/util/named_values.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

// An estimator that needs a good initial guess: a redescending loss at its
// final width from the first iteration.
Estimator MakeDirectTukey() {
  EstimatorOptions options;
  options.schedule = RobustSchedule::kDirect;
  return Estimator(options, MakeRobustCosts("bidirectional_point", "tukey"));
}

// The number of 30 large motions estimated correctly with 40 % outliers.
int CountRight(const std::string& guess_name) {
  const InitialGuess* guess = FindNamed(InitialGuesses(), guess_name);
  Estimator estimator = MakeDirectTukey();
  int right = 0;
  for (int seed = 0; seed < 30; ++seed) {
    RandomWorld world(600 + seed);
    const Eigen::Vector3d axis = world.Vector(1.0).normalized();
    const Rigid3d truth(
        Eigen::Quaterniond(Eigen::AngleAxisd(world.Uniform(0.3, 0.6), axis)),
        world.Vector(0.5));
    const Correspondences matches = world.Matches(300, 0.4, truth);
    const std::optional<Rigid3d> start = guess->find(matches);
    if (!start) continue;
    const MotionEstimate estimate = estimator.Estimate(matches, *start);
    const MotionError error = ErrorOf(estimate.cur_from_prev, truth);
    // 180 right matches: 1 mm and 0.6 mrad on average.
    if (estimate.ok() && error.translation < 0.006 && error.angle < 0.004) {
      ++right;
    }
  }
  return right;
}

TEST(InitialGuessTest, RansacAndCliqueMakeADirectSolveSafe) {
  EXPECT_EQ(CountRight("ransac"), 30);
  EXPECT_EQ(CountRight("clique"), 30);
}

TEST(InitialGuessTest, TheSameSolveFailsFromNoMotion) {
  EXPECT_EQ(CountRight("identity"), 0)
      << "the motions of the other test are no challenge";
}

TEST(InitialGuessTest, OnlyIdentityNeedsNoMatches) {
  const Correspondences none;
  EXPECT_EQ(InitialGuesses().size(), 3U);
  for (const InitialGuess& guess : InitialGuesses()) {
    EXPECT_EQ(guess.find(none).has_value(), guess.name == "identity");
  }
}

}  // namespace
}  // namespace rgbd_pose
