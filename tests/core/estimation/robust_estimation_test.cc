// The estimator with every loss, scale estimator and schedule.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/util/named_values.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "robust/scale.h"
#include "tests/support/motion_error.h"
#include "tests/support/noise_model.h"

namespace rgbd_pose {
namespace {

constexpr char kCost[] = "bidirectional_point";

Estimator EstimatorOfScale(const std::string& loss, const std::string& scale,
                           RobustSchedule schedule = RobustSchedule::kGnc) {
  EstimatorOptions options;
  options.schedule = schedule;
  options.scale = FindNamed(ScaleEstimators(), scale)->estimate;
  return Estimator(options, MakeRobustCosts(kCost, loss));
}

class EveryLossTest : public ::testing::TestWithParam<std::string> {};

// 300 matches determine the motion to about 0.3 mrad and 0.6 mm.
TEST_P(EveryLossTest, EstimatesACleanMotion) {
  Estimator estimator = EstimatorOfScale(GetParam(), "fixed");
  for (int seed = 0; seed < 10; ++seed) {
    RandomWorld world(300 + seed);
    const Rigid3d truth = world.Motion(0.2, 0.2);
    const MotionEstimate estimate =
        estimator.Estimate(world.Matches(300, 0.0, truth));
    ASSERT_TRUE(estimate.ok()) << estimate.reason;
    const MotionError error = ErrorOf(estimate.cur_from_prev, truth);
    EXPECT_LE(error.angle, 0.001);
    EXPECT_LE(error.translation, 0.002);
    EXPECT_NEAR(estimate.sigma, 1.0, 0.15);         // 300 norms: 3 sigmas
    EXPECT_NEAR(estimate.num_inliers, 297, 3 * 2);  // 99 %, binomial
    EXPECT_TRUE(estimate.covariance.allFinite());
  }
}

TEST_P(EveryLossTest, FindsANoiselessMotionExactly) {
  RandomWorld world(31);
  const Rigid3d truth = world.Motion(0.2, 0.2);
  const MotionEstimate estimate =
      EstimatorOfScale(GetParam(), "fixed")
          .Estimate(world.Matches(300, 0.0, truth, /*noise=*/false));
  ASSERT_TRUE(estimate.ok()) << estimate.reason;
  const MotionError error = ErrorOf(estimate.cur_from_prev, truth);
  constexpr double kSolver = 1e-8;  // limited by the solver's tolerances
  EXPECT_LE(error.angle, kSolver);
  EXPECT_LE(error.translation, kSolver);
  EXPECT_EQ(estimate.num_inliers, 300);
}

TEST_P(EveryLossTest, WeightsLieBetweenZeroAndOne) {
  const MotionEstimate estimate =
      EstimatorOfScale(GetParam(), "fixed")
          .Estimate(RandomWorld(72).Matches(300, 0.2, Rigid3d()));
  EXPECT_THAT(estimate.weights, testing::Each(testing::AllOf(
                                    testing::Ge(0.0), testing::Le(1.0))));
}

INSTANTIATE_TEST_SUITE_P(Losses, EveryLossTest,
                         ::testing::ValuesIn(MEstimatorNames()),
                         [](const auto& info) { return info.param; });

class EveryScaleTest : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Scales, EveryScaleTest,
                         ::testing::Values("mad", "sn", "qn"),
                         [](const auto& info) { return info.param; });

// The noise is three times the model's. With the scale estimated, the result is
// as good as with the right model.
TEST_P(EveryScaleTest, MakesUpForAWrongNoiseModel) {
  constexpr double kFactor = 3.0;
  constexpr int kTrials = 40;
  Estimator unscaled = EstimatorOfScale("tukey", "fixed");
  Estimator scaled = EstimatorOfScale("tukey", GetParam());
  double wrong = 0.0, right = 0.0, found = 0.0, sigma = 0.0;
  double wrong_share = 0.0, right_share = 0.0, found_share = 0.0;
  for (int seed = 0; seed < kTrials; ++seed) {
    RandomWorld world(400 + seed);
    const Rigid3d truth = world.Motion(0.1, 0.1);
    const Correspondences clean =
        WithSigmas(world.Matches(300, 0.0, truth, /*noise=*/false), kFactor);
    Correspondences right_model(clean.camera());
    for (size_t i = 0; i < clean.size(); ++i) {
      Observation prev = clean[i].prev;
      Observation cur = clean[i].cur;
      world.AddNoise(&prev);
      world.AddNoise(&cur);
      right_model.Add(prev, cur);
    }
    const Correspondences wrong_model = WithSigmas(right_model, 1.0 / kFactor);
    const auto add = [&truth](const MotionEstimate& estimate, double* error,
                              double* share) {
      *error += ErrorOf(estimate.cur_from_prev, truth).translation / kTrials;
      *share += estimate.num_inliers / 300.0 / kTrials;
    };
    add(unscaled.Estimate(right_model), &right, &right_share);
    add(unscaled.Estimate(wrong_model), &wrong, &wrong_share);
    const MotionEstimate estimate = scaled.Estimate(wrong_model);
    ASSERT_TRUE(estimate.ok()) << estimate.reason;
    add(estimate, &found, &found_share);
    sigma += estimate.sigma / kTrials;
  }
  EXPECT_NEAR(sigma, kFactor, 0.05 * kFactor);  // 12,000 matches: 1 %
  // Widths that are wrong by a few percent change the error by far less.
  EXPECT_LE(found, 1.02 * right);
  EXPECT_NEAR(found_share, right_share, 0.01);
  // With the fixed scale the errors are larger, and few matches are inliers.
  EXPECT_GT(wrong, 1.3 * right);
  EXPECT_LT(wrong_share, 0.5);
}

TEST_P(EveryScaleTest, LeavesARightNoiseModelAndOutliersAlone) {
  Estimator unscaled = EstimatorOfScale("tukey", "fixed");
  Estimator scaled = EstimatorOfScale("tukey", GetParam());
  double expected = 0.0, actual = 0.0;
  for (int seed = 0; seed < 40; ++seed) {
    RandomWorld world(500 + seed);
    const Rigid3d truth = world.Motion(0.1, 0.1);
    const Correspondences matches = world.Matches(300, 0.3, truth);
    const MotionEstimate estimate = scaled.Estimate(matches);
    ASSERT_TRUE(estimate.ok()) << estimate.reason;
    actual += ErrorOf(estimate.cur_from_prev, truth).translation;
    expected +=
        ErrorOf(unscaled.Estimate(matches).cur_from_prev, truth).translation;
  }
  // Outliers increase the scale, and with it Tukey's width, by up to a half.
  EXPECT_LE(actual, 1.15 * expected);
}

// Over half of the residuals are zero, so the scale estimate is zero.
TEST_P(EveryScaleTest, NoiselessMatchesHaveADefinedEstimate) {
  for (const double outliers : {0.0, 0.2}) {
    RandomWorld world(32);
    const Rigid3d truth = world.Motion(0.1, 0.1);
    const MotionEstimate estimate =
        EstimatorOfScale("tukey", GetParam())
            .Estimate(world.Matches(300, outliers, truth, /*noise=*/false));
    ASSERT_TRUE(estimate.ok()) << estimate.reason;
    const MotionError error = ErrorOf(estimate.cur_from_prev, truth);
    constexpr double kSolver = 1e-8;
    EXPECT_LE(error.angle, kSolver);
    EXPECT_LE(error.translation, kSolver);
    EXPECT_TRUE(estimate.covariance.allFinite());
    EXPECT_TRUE(std::isfinite(estimate.sigma));
    EXPECT_THAT(estimate.weights, testing::Each(testing::AllOf(
                                      testing::Ge(0.0), testing::Le(1.0))));
  }
}

TEST_P(EveryScaleTest, AHandfulOfMatchesHasADefinedEstimate) {
  Estimator estimator = EstimatorOfScale("tukey", GetParam());
  for (const int count : {0, 1, 2, 3, 4, 5, 9, 10}) {
    RandomWorld world(33);
    const Rigid3d truth = world.Motion(0.05, 0.05);
    const MotionEstimate estimate =
        estimator.Estimate(world.Matches(count, 0.0, truth));
    EXPECT_TRUE(estimate.cur_from_prev.IsFinite()) << count << " matches";
    EXPECT_TRUE(estimate.covariance.allFinite()) << count << " matches";
    EXPECT_TRUE(std::isfinite(estimate.sigma)) << count << " matches";
    EXPECT_TRUE(std::isfinite(estimate.final_cost)) << count << " matches";
    EXPECT_EQ(estimate.ok(), estimate.reason.empty()) << estimate.reason;
    if (count < 3) {
      EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches);
    }
  }
}

// The residuals of few matches are small because the motion is fitted to them:
// their spread is no scale.
TEST_P(EveryScaleTest, IsHonestForFewMatches) {
  constexpr int kTrials = 200;
  for (const char* cost : {"reprojection", "bidirectional_point"}) {
    EstimatorOptions options;
    options.scale = FindNamed(ScaleEstimators(), GetParam())->estimate;
    Estimator estimator(options, MakeRobustCosts(cost, "tukey"));
    for (const int count : {5, 6, 8, 12}) {
      int ok = 0, wrong = 0;
      for (int seed = 0; seed < kTrials; ++seed) {
        RandomWorld world(8000 + seed);
        const Rigid3d truth = world.Motion(0.1, 0.1);
        const MotionEstimate estimate =
            estimator.Estimate(world.Matches(count, 0.0, truth));
        if (!estimate.ok()) continue;
        ++ok;
        wrong += SquaredMahalanobisDistance(estimate.cur_from_prev, truth,
                                            estimate.covariance) > 40.9;
      }
      EXPECT_GE(ok, 0.9 * kTrials) << cost << ", " << count << " matches";
      EXPECT_LE(wrong, 2) << cost << ", " << count << " matches";
    }
  }
}

// 70 % of the matches are outliers, and the guess is far outside Tukey's width.
// With graduation, nearly all of 100 motions of 0.1 rad and 0.1 m are found.
TEST(ScheduleTest, GraduationSurvivesSeventyPercentOutliers) {
  constexpr int kTrials = 100;
  constexpr int kMatches = 300;
  const auto success = [](RobustSchedule schedule) {
    Estimator clean = EstimatorOfScale("tukey", "fixed");
    Estimator estimator = EstimatorOfScale("tukey", "fixed", schedule);
    std::vector<MotionError> errors;
    double angle = 0.0, translation = 0.0;  // without outliers
    for (int seed = 0; seed < kTrials; ++seed) {
      RandomWorld world(600 + seed);
      const Rigid3d truth(Eigen::Quaterniond(Eigen::AngleAxisd(
                              0.1, world.Vector(1.0).normalized())),
                          0.1 * world.Vector(1.0).normalized());
      const MotionError error = ErrorOf(
          clean.Estimate(world.Matches(kMatches, 0.0, truth)).cur_from_prev,
          truth);
      angle += error.angle / kTrials;
      translation += error.translation / kTrials;
      errors.push_back(ErrorOf(
          estimator.Estimate(world.Matches(kMatches, 0.7, truth)).cur_from_prev,
          truth));
    }
    const auto found = [&](const MotionError& error) {
      return error.angle <= 5.0 * angle &&
             error.translation <= 5.0 * translation;
    };
    return static_cast<double>(
               std::count_if(errors.begin(), errors.end(), found)) /
           kTrials;
  };
  EXPECT_GE(success(RobustSchedule::kGnc), 0.95);
  EXPECT_LE(success(RobustSchedule::kDirect), 0.5);
}

// Where over half of the matches are inliers, few stages are needed: without
// outliers as many iterations as two stages take, with many outliers more.
TEST(ScheduleTest, StagesAreSavedWhereMatchesAgree) {
  Estimator estimator = EstimatorOfScale("tukey", "fixed");
  RandomWorld world(34);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  const int clean =
      estimator.Estimate(world.Matches(300, 0.0, truth)).iterations;
  const int dirty =
      estimator.Estimate(world.Matches(300, 0.7, truth)).iterations;
  EXPECT_LE(clean, 8);
  EXPECT_GE(dirty, 12);
}

// Nine residuals minus six parameters are too few to estimate a scale.
TEST(ScaleTest, OfThreeMatchesTheNoiseModelIsTaken) {
  RandomWorld world(73);
  const Correspondences matches = world.Matches(3, 0.0, world.Motion(0.1, 0.1));
  EstimatorOptions options;
  options.max_standard_deviation = 10.0;
  const auto costs = [] { return MakeRobustCosts("point_to_point", "none"); };
  const MotionEstimate fixed = Estimator(options, costs()).Estimate(matches);
  options.scale = MadScale;
  const MotionEstimate scaled = Estimator(options, costs()).Estimate(matches);
  ASSERT_TRUE(fixed.ok()) << fixed.reason;
  EXPECT_EQ(scaled.covariance, fixed.covariance);
}

// Three quarters of the matches agree: enough for a minimum of 0.6, not 0.85.
TEST(InlierShareTest, IsJudged) {
  RandomWorld world(72);
  const Correspondences matches =
      world.Matches(400, 0.25, world.Motion(0.1, 0.1));
  for (const double share : {0.6, 0.85}) {
    EstimatorOptions options;
    options.min_inlier_share = share;
    const MotionEstimate estimate =
        Estimator(options, MakeRobustCosts("bidirectional_point", "tukey"))
            .Estimate(matches);
    EXPECT_EQ(estimate.status,
              share < 0.7 ? EstimateStatus::kOk : EstimateStatus::kInconsistent)
        << estimate.reason;
  }
}

// Least squares with outliers leaves huge residuals. A scale fitted to them
// would make all matches inliers.
TEST(ScaleTest, AScaleThatOnlyFitsWrongMatchesIsNoSuccess) {
  RandomWorld world(71);
  for (const std::string scale : {"mad", "sn", "qn"}) {
    const MotionEstimate estimate =
        EstimatorOfScale("none", scale)
            .Estimate(world.Matches(300, 0.2, world.Motion(0.1, 0.1)));
    EXPECT_EQ(estimate.status, EstimateStatus::kInconsistent) << scale;
    EXPECT_NE(estimate.reason, "") << scale;
  }
}

}  // namespace
}  // namespace rgbd_pose
