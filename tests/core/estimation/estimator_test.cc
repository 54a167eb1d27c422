#include "core/estimation/estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "robust/scale.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

Estimator MakeEstimator(const std::string& loss,
                        Assembly assembly = Assembly::kCompressed) {
  EstimatorOptions options;
  options.assembly = assembly;
  return Estimator(options, MakeRobustCosts("bidirectional_point", loss));
}

TEST(EstimatorTest, TheThreeAssembliesAgree) {
  RandomWorld world(12);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  const Correspondences matches = world.Matches(200, 0.2, truth);
  const MotionEstimate expected =
      MakeEstimator("tukey", Assembly::kPerMatch).Estimate(matches);
  for (const Assembly assembly : {Assembly::kAutodiff, Assembly::kCompressed}) {
    const MotionEstimate actual =
        MakeEstimator("tukey", assembly).Estimate(matches);
    const MotionError error =
        ErrorOf(actual.cur_from_prev, expected.cur_from_prev);
    EXPECT_LE(error.angle, 1e-9);
    EXPECT_LE(error.translation, 1e-9);
    EXPECT_EQ(actual.iterations, expected.iterations);
    EXPECT_EQ(actual.is_inlier, expected.is_inlier);
  }
}

// 30 % of the matches are outliers: with Tukey's loss the error stays below
// three times the error without outliers.
TEST(EstimatorTest, TukeySurvivesThirtyPercentOutliers) {
  double clean = 0.0, dirty = 0.0, clean_angle = 0.0, dirty_angle = 0.0;
  Estimator estimator = MakeEstimator("tukey");
  constexpr int kTrials = 30;
  for (int seed = 0; seed < kTrials; ++seed) {
    for (const double outliers : {0.0, 0.3}) {
      RandomWorld world(100 + seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      const MotionEstimate estimate =
          estimator.Estimate(world.Matches(300, outliers, truth));
      ASSERT_TRUE(estimate.ok()) << estimate.reason;
      const MotionError error = ErrorOf(estimate.cur_from_prev, truth);
      (outliers > 0 ? dirty : clean) += error.translation;
      (outliers > 0 ? dirty_angle : clean_angle) += error.angle;
      if (outliers > 0) {
        // Limit for each single trial: half the inlier share.
        EXPECT_LE(error.translation, 0.01);
        EXPECT_NEAR(estimate.num_inliers, 208, 25);  // 99 % of 210
      }
    }
  }
  EXPECT_LE(dirty, 3.0 * clean);
  EXPECT_LE(dirty_angle, 3.0 * clean_angle);
}

TEST(EstimatorTest, LeastSquaresIsRuinedByTheSameOutliers) {
  RandomWorld world(100);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  const Correspondences matches = world.Matches(300, 0.3, truth);
  const MotionEstimate estimate = MakeEstimator("none").Estimate(matches);
  EXPECT_GT(ErrorOf(estimate.cur_from_prev, truth).translation, 0.02)
      << "the outliers of the other tests are no challenge";
}

// Weights must follow from the reported norms: Huber's weight is 1 up to its
// width and width / norm beyond. The norms also follow the distribution of the
// noise.
TEST(EstimatorTest, ResidualNormsExplainTheWeights) {
  RandomWorld world(13);
  const MotionEstimate estimate = MakeEstimator("huber").Estimate(
      world.Matches(2000, 0.0, world.Motion(0.1, 0.1)));
  ASSERT_TRUE(estimate.ok()) << estimate.reason;
  ASSERT_EQ(estimate.residual_norms.size(), 2000u);
  const double width = FindNamed(MEstimators(), "huber")->Width95(3);
  double sum_of_squares = 0.0;
  for (size_t i = 0; i < estimate.residual_norms.size(); ++i) {
    EXPECT_EQ(estimate.residual_degrees[i], 3);
    const double norm = estimate.residual_norms[i];
    EXPECT_NEAR(estimate.weights[i], norm <= width ? 1.0 : width / norm, 1e-12);
    sum_of_squares += norm * norm;
  }
  // Over 2000 matches, the mean of chi^2 with 3 degrees has a sigma of 0.055.
  EXPECT_NEAR(sum_of_squares / 2000, 3.0, 0.3);
}

// 99 % of right matches are inliers, for every cost. With 20 000 matches the
// share has a sigma of 0.0007.
class InlierShareTest : public ::testing::TestWithParam<std::string> {};

TEST_P(InlierShareTest, Is99Percent) {
  Estimator estimator({}, MakeRobustCosts(GetParam(), "huber"));
  int used = 0, inliers = 0;
  for (int seed = 0; seed < 20; ++seed) {
    RandomWorld world(500 + seed);
    const bool no_depth = GetParam() == "epipolar";
    Rigid3d truth = world.Motion(0.05, 0.05);
    truth.translation.x() += no_depth ? 0.5 : 0.0;
    const Correspondences matches =
        world.Matches(1000, 0.0, truth, /*noise=*/true, no_depth ? 1.0 : 0.0);
    const MotionEstimate estimate = estimator.Estimate(matches, truth);
    used += estimate.num_used;
    inliers += estimate.num_inliers;
  }
  EXPECT_NEAR(static_cast<double>(inliers) / used, 0.99, 0.0025);
}

INSTANTIATE_TEST_SUITE_P(
    Costs, InlierShareTest,
    ::testing::Values("bidirectional_point", "bidirectional_image",
                      "point_to_point", "mahalanobis_point", "point_to_plane",
                      "reprojection", "reprojection_depth"),
    [](const auto& info) { return info.param; });

TEST(EstimatorTest, CountsWhatWasRejectedAsNotFinite) {
  Correspondences matches;
  const Observation bad{std::nan(""), 0, 1, 1, 1};
  for (int i = 0; i < 5; ++i) matches.Add(bad, bad);
  const MotionEstimate estimate = MakeEstimator("tukey").Estimate(matches);
  EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches);
  EXPECT_NE(estimate.reason.find("5 rejected"), std::string::npos);
}

TEST(EstimatorTest, AGuessThatIsNotFiniteIsSaidToBe) {
  RandomWorld world(1);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  Rigid3d guess;
  guess.translation.y() = std::nan("");
  const MotionEstimate estimate =
      Estimator({}, MakeRobustCosts())
          .Estimate(world.Matches(100, 0.0, truth), guess);
  EXPECT_EQ(estimate.status, EstimateStatus::kNotConverged);
  EXPECT_EQ(estimate.reason, "the guess is not finite");
  EXPECT_EQ(estimate.iterations, 0);
  EXPECT_TRUE(estimate.cur_from_prev.IsFinite());
}

// A frame against itself: the measurements are still rounded, and the noise
// model counts as six of their rows, so as 3 % of 200 matches and more where
// rows weigh unequally.
TEST(EstimatorTest, EqualFramesAreNotCertain) {
  RandomWorld world(16);
  const Correspondences noisy = world.Matches(200, 0.0, Rigid3d());
  Correspondences equal(noisy.camera());
  for (const Match& match : noisy) equal.Add(match.prev, match.prev);
  for (const char* cost : {"bidirectional_point", "point_to_point"}) {
    for (const char* scale : {"fixed", "mad"}) {
      EstimatorOptions options;
      options.scale = FindNamed(ScaleEstimators(), scale)->estimate;
      Estimator estimator(options, MakeRobustCosts(cost, "tukey"));
      const MotionEstimate estimate = estimator.Estimate(equal);
      ASSERT_TRUE(estimate.ok()) << estimate.reason;
      const MotionMatrix usual = estimator.Estimate(noisy).covariance;
      for (int i = 0; i < 6; ++i) {
        const double share = estimate.covariance(i, i) / usual(i, i);
        EXPECT_GT(share, std::pow(0.03, 2)) << cost << " " << scale;
        EXPECT_LT(share, std::pow(0.3, 2)) << cost << " " << scale;
      }
    }
  }
}

TEST(EstimatorTest, MatchesThatContradictEachOtherAreInconsistent) {
  RandomWorld world(15);
  const MotionEstimate estimate =
      MakeEstimator("huber").Estimate(world.Matches(200, 1.0, Rigid3d()));
  EXPECT_FALSE(estimate.ok());
  EXPECT_NE(estimate.reason, "");
}

TEST(EstimatorTest, DoesTheSameEachTime) {
  RandomWorld world(16);
  Estimator estimator = MakeEstimator("tukey");
  const Correspondences matches =
      world.Matches(300, 0.3, world.Motion(0.1, 0.1));
  const MotionEstimate first = estimator.Estimate(matches);
  estimator.Estimate(world.Matches(17, 0.0, Rigid3d()));  // has no effect
  const MotionEstimate second = estimator.Estimate(matches);
  EXPECT_EQ(first.cur_from_prev.translation, second.cur_from_prev.translation);
  EXPECT_EQ(first.weights, second.weights);
  EXPECT_EQ(first.final_cost, second.final_cost);
}

TEST(EstimatorOptionsTest, WhatIsNotSoundIsRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<EstimatorOptions> bad;
  for (const double value : {kNan, -1.0}) {
    for (double EstimatorOptions::*field :
         {&EstimatorOptions::gnc_factor, &EstimatorOptions::min_inlier_share,
          &EstimatorOptions::max_scale,
          &EstimatorOptions::max_standard_deviation}) {
      bad.emplace_back().*field = value;
    }
  }
  bad.emplace_back().gnc_factor = 1.0;
  bad.emplace_back().min_inlier_share = 1.1;
  bad.emplace_back().max_iterations = 0;
  bad.emplace_back().threads = 0;
  for (const EstimatorOptions& options : bad) {
    EXPECT_THROW(Estimator(options, MakeRobustCosts()), InputError)
        << options.Check();
  }
  EXPECT_EQ(EstimatorOptions().Check(), "");
}

// Odometry continues from such a motion, and its edge needs the covariance.
TEST(EstimatorTest, OneThatWasStoppedHasACovariance) {
  RandomWorld world(18);
  const Correspondences matches =
      world.Matches(100, 0.0, world.Motion(0.2, 0.3));
  EstimatorOptions options;
  options.max_iterations = 1;
  const MotionEstimate estimate =
      Estimator(options, MakeRobustCosts()).Estimate(matches);
  ASSERT_EQ(estimate.status, EstimateStatus::kNotConverged) << estimate.reason;
  EXPECT_GT(estimate.covariance.diagonal().minCoeff(), 0.0);
}

// The noise is four times the model's. Initial and final cost are both
// evaluated with the estimated scale.
TEST(EstimatorTest, BothCostsCountTheScale) {
  RandomWorld world(19);
  const Camera camera;
  Correspondences matches(camera);
  for (int i = 0; i < 300; ++i) {
    Observation prev, cur;
    world.Match(camera, Rigid3d(), &prev, &cur);
    for (int k = 0; k < 16; ++k) {
      world.AddNoise(&prev);
      world.AddNoise(&cur);
    }
    matches.Add(prev, cur);
  }
  EstimatorOptions options;
  options.scale = MadScale;
  Estimator estimator(options, MakeRobustCosts("bidirectional_point", "tukey"));
  const MotionEstimate estimate = estimator.Estimate(matches);
  ASSERT_TRUE(estimate.ok()) << estimate.reason;
  MotionEstimate reused = estimate;
  estimator.Estimate({&matches}, estimate.cur_from_prev, &reused);
  EXPECT_NEAR(reused.initial_cost, reused.final_cost, 0.01 * reused.final_cost);
  EXPECT_GE(estimate.initial_cost, estimate.final_cost);
  estimator.Estimate(FramePair(), Rigid3d(), &reused);
  EXPECT_EQ(reused.initial_cost, 0.0);
}

TEST(CostFactoryTest, NamesWhatIsUnknown) {
  EXPECT_THROW(MakeRobustCosts("bidirectional", "tukey"), InputError);
  EXPECT_THROW(MakeRobustCosts("bidirectional_point", "tuckey"), InputError);
  EXPECT_THROW(MakeRobustCosts("bidirectional_point", "tukey,huber"),
               InputError);
}

}  // namespace
}  // namespace rgbd_pose
