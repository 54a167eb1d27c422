// Monte Carlo test: does an estimate's covariance match its actual error?

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/geometry/motion.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/scale.h"
#include "tests/support/noise_model.h"

namespace rgbd_pose {
namespace {

constexpr int kTrials = 500;       // give the mean a sigma of 0.15
constexpr int kFewerTrials = 200;  // of 0.24
constexpr int kCovarianceMatches = 250;
constexpr double kPriorSigma = 0.002;  // rad, m: about that of the matches

struct Scene {
  const char* costs;
  const char* losses;
  double missing_depth_share;
  double outlier_share;
  double tolerance;  // of the mean, which is 6
};

std::ostream& operator<<(std::ostream& out, const Scene& scene) {
  return out << scene.costs << ", outliers " << scene.outlier_share
             << ", missing depths " << scene.missing_depth_share;
}

// The error squared in units of the covariance; its mean is 6.
double Nees(const MotionEstimate& estimate, const Rigid3d& truth) {
  return SquaredMahalanobisDistance(estimate.cur_from_prev, truth,
                                    estimate.covariance);
}

class CovarianceTest : public ::testing::TestWithParam<Scene> {};

// The normalised estimation error squared, d^T covariance^-1 d, has a mean of 6
// if the covariance is correct. Costs that use a measurement twice would count
// it twice if this were not corrected.
TEST_P(CovarianceTest, IsHonest) {
  const Scene& scene = GetParam();
  const int trials = scene.tolerance < 1.0 ? kTrials : kFewerTrials;
  Estimator estimator({}, MakeRobustCosts(scene.costs, scene.losses));
  double nees = 0.0;
  for (int seed = 0; seed < trials; ++seed) {
    RandomWorld world(1000 + seed);
    const Rigid3d truth = world.Motion(0.05, 0.05);
    const Correspondences matches =
        world.Matches(kCovarianceMatches, scene.outlier_share, truth,
                      /*noise=*/true, scene.missing_depth_share);
    const MotionPrior prior = world.Prior(truth, kPriorSigma);
    const MotionEstimate estimate =
        estimator.Estimate(matches, Rigid3d(), &prior);
    ASSERT_TRUE(estimate.ok()) << estimate.reason << ", seed " << seed;
    nees += Nees(estimate, truth);
  }
  RecordProperty("nees", std::to_string(nees / trials));
  EXPECT_NEAR(nees / trials, 6.0, scene.tolerance);
}

// If the prior provides nearly all information, the estimate has the prior's
// covariance, whatever the scatter of the matches.
TEST(CovarianceOfAPriorTest, DoesNotDependOnTheNoiseOfMatches) {
  RandomWorld world(5);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const Correspondences matches = world.Matches(kCovarianceMatches, 0.0, truth);
  const MotionPrior prior{truth, 1e12 * MotionMatrix::Identity()};
  for (const char* loss : {"none", "tukey"}) {
    Estimator estimator({}, MakeRobustCosts("reprojection_depth+motion_prior",
                                            std::string(loss) + ",none"));
    for (const double noise : {1.0 / 3.0, 1.0, 3.0}) {
      const MotionEstimate estimate =
          estimator.Estimate(WithSigmas(matches, 1.0 / noise), truth, &prior);
      for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(std::sqrt(estimate.covariance(i, i)), 1e-6, 1e-8)
            << loss << ", noise " << noise << ", parameter " << i;
      }
    }
  }
}

// Matches and prior provide about the same information. The noise model is
// wrong and the scale is estimated: both must have their correct weight in the
// motion and in its covariance.
TEST(CovarianceOfAPriorTest, IsHonestWhereTheScaleIsEstimated) {
  EstimatorOptions options;
  options.scale = MadScale;
  Estimator estimator(
      options,
      MakeRobustCosts("reprojection_depth+motion_prior", "tukey,none"));
  for (const double noise : {1.0 / 3.0, 3.0}) {
    double nees = 0.0;
    for (int seed = 0; seed < kTrials; ++seed) {
      RandomWorld world(3000 + seed);
      const Rigid3d truth = world.Motion(0.05, 0.05);
      const Correspondences matches = WithSigmas(
          world.Matches(kCovarianceMatches, 0.0, truth), 1.0 / noise);
      const MotionPrior prior = world.Prior(truth, kPriorSigma);
      const MotionEstimate estimate =
          estimator.Estimate(matches, Rigid3d(), &prior);
      ASSERT_TRUE(estimate.ok()) << estimate.reason << ", seed " << seed;
      nees += Nees(estimate, truth);
    }
    EXPECT_NEAR(nees / kTrials, 6.0, 0.6) << "noise " << noise;
  }
}

// Least absolute values fit some matches exactly. Their weight, which is
// nearly infinite, must not count as information.
TEST(CovarianceOfSteepLossesTest, FittedResidualsAreNotCertain) {
  struct Setting {
    const char* cost;
    int matches;
  };
  for (const Setting& setting : {Setting{"point_to_plane", 300},
                                 {"bidirectional_point", 30},
                                 {"reprojection", 100}}) {
    Estimator estimator({}, MakeRobustCosts(setting.cost, "l1"));
    double nees = 0.0;
    int ok = 0;
    for (int seed = 0; seed < 150; ++seed) {
      RandomWorld world(seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      const MotionEstimate estimate =
          estimator.Estimate(world.Matches(setting.matches, 0.0, truth));
      if (!estimate.ok()) continue;
      nees += Nees(estimate, truth) / 6.0;
      ++ok;
    }
    EXPECT_GT(ok, 30) << setting.cost;
    EXPECT_LT(nees / ok, 1.8) << setting.cost;  // 3 to 12 otherwise
  }
}

// Few matches fit so many residuals exactly that the weights of these must not
// count as information either.
TEST(CovarianceOfSteepLossesTest, IsHonestForFewMatches) {
  struct Setting {
    const char* cost;
    const char* loss;
    int matches;
  };
  for (const Setting& setting : {Setting{"bidirectional_point", "l1", 3},
                                 {"bidirectional_point", "lp", 3},
                                 {"reprojection", "l1", 4},
                                 {"reprojection", "lp", 6}}) {
    Estimator estimator({}, MakeRobustCosts(setting.cost, setting.loss));
    double nees = 0.0;
    int ok = 0, wrong = 0;
    for (int seed = 0; seed < kTrials; ++seed) {
      RandomWorld world(7000 + seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      const MotionEstimate estimate =
          estimator.Estimate(world.Matches(setting.matches, 0.0, truth));
      if (!estimate.ok()) continue;
      const double chi_squared = Nees(estimate, truth);
      nees += chi_squared / 6.0;
      ++ok;
      wrong += chi_squared > 40.9;  // as rare as five sigmas
    }
    EXPECT_GT(ok, kTrials / 3) << setting.cost << " " << setting.loss;
    EXPECT_LT(nees / ok, 1.2) << setting.cost << " " << setting.loss;
    EXPECT_LE(wrong, ok / 200) << setting.cost << " " << setting.loss;
  }
}

// Under Huber's loss many gross outliers pull the motion away from all others
// by more than its covariance says; with few of them, or symmetric ones, not.
TEST(OutliersThatPullTest, AreNotOk) {
  struct Setting {
    const char* cost;
    const char* loss;
    double outliers;
    bool are_ok;
  };
  for (const Setting& setting :
       {Setting{"reprojection_depth", "huber", 0.4, false},
        {"reprojection_depth", "huber", 0.1, true},
        {"reprojection_depth", "tukey", 0.4, true},
        {"bidirectional_point", "huber", 0.4, true}}) {
    Estimator estimator({}, MakeRobustCosts(setting.cost, setting.loss));
    for (int seed = 0; seed < 20; ++seed) {
      RandomWorld world(seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      const MotionEstimate estimate =
          estimator.Estimate(world.Matches(300, setting.outliers, truth));
      EXPECT_EQ(estimate.ok(), setting.are_ok)
          << setting.cost << ", " << setting.loss << ", outliers "
          << setting.outliers << ", seed " << seed << ": " << estimate.reason;
    }
  }
}

// A cost that is not whitened has another limit for each match. Three of ten
// matches are of an object that moves by 10 cm.
TEST(OutliersThatPullTest, AreNoticedByACostThatIsNotWhitened) {
  for (const char* loss : {"huber", "fair", "tukey"}) {
    Estimator estimator({}, MakeRobustCosts("point_to_point", loss));
    for (int seed = 0; seed < 20; ++seed) {
      RandomWorld world(seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      const Rigid3d moved(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0});
      Correspondences matches = world.Matches(210, 0.0, truth);
      const Correspondences wrong = world.Matches(90, 0.0, moved * truth);
      for (const Match& match : wrong) matches.Add(match.prev, match.cur);
      const MotionEstimate estimate = estimator.Estimate(matches);
      EXPECT_EQ(estimate.ok(), loss == std::string("tukey"))
          << loss << ", seed " << seed << ": " << estimate.reason;
    }
  }
}

// Nothing is wrong but the sigmas of the matches, a quarter of what they should
// be. The estimated scale tells how matches and prior weigh; without it the
// matches alone would be elsewhere.
TEST(OutliersThatPullTest, AreNoneIfSigmasAreTooSmall) {
  EstimatorOptions options;
  options.scale = MadScale;
  for (const char* cost : {"reprojection_depth", "point_to_point"}) {
    Estimator estimator(
        options,
        MakeRobustCosts(cost + std::string("+motion_prior"), "huber,none"));
    for (int seed = 0; seed < 40; ++seed) {
      RandomWorld world(seed);
      const Rigid3d truth = world.Motion(0.1, 0.1);
      const Correspondences matches =
          WithSigmas(world.Matches(300, 0.0, truth), 0.25);
      const MotionPrior prior = world.Prior(truth, 1e-4);
      const MotionEstimate estimate =
          estimator.Estimate(matches, Rigid3d(), &prior);
      EXPECT_TRUE(estimate.ok())
          << cost << ", seed " << seed << ": " << estimate.reason;
    }
  }
}

// A prior with a wrong mean and no loss moves the estimate by many sigmas of
// the matches, or is moved by many of its own. (A prior that is more exact than
// the matches by far, so that they do not contradict it, cannot be noticed.)
TEST(CovarianceOfAPriorTest, AWrongPriorIsNoticed) {
  Estimator estimator(
      {}, MakeRobustCosts("reprojection_depth+motion_prior", "none,none"));
  for (const double sigma : {1e-3, 3e-3, 1e-2}) {
    for (int seed = 0; seed < 30; ++seed) {
      RandomWorld world(4000 + seed);
      const Rigid3d truth = world.Motion(0.05, 0.05);
      const Correspondences matches =
          world.Matches(kCovarianceMatches, 0.0, truth);
      MotionPrior prior = world.Prior(truth, sigma);
      const MotionEstimate right =
          estimator.Estimate(matches, Rigid3d(), &prior);
      EXPECT_TRUE(right.ok()) << right.reason << ", sigma " << sigma;
      prior.mean.translation += 20.0 * sigma * Eigen::Vector3d::Unit(seed % 3);
      const MotionEstimate wrong =
          estimator.Estimate(matches, Rigid3d(), &prior);
      EXPECT_EQ(wrong.status, EstimateStatus::kInconsistent)
          << "sigma " << sigma << ", seed " << seed;
    }
  }
}

std::string SceneName(const ::testing::TestParamInfo<Scene>& info) {
  const auto percent = [](double share) {
    return std::to_string(static_cast<int>(100.0 * share));
  };
  std::string name = info.param.costs;
  std::replace(name.begin(), name.end(), '+', '_');
  return name + "_wrong" + percent(info.param.outlier_share) + "_missing" +
         percent(info.param.missing_depth_share);
}

constexpr double kDefault = 0.6;  // 10 %, for the default cost
constexpr double kOther = 1.5;    // 25 %

// Each cost with and without outliers. Epipolar matches are used where a depth
// is missing.
std::vector<Scene> Scenes() {
  std::vector<Scene> scenes;
  for (const double outliers : {0.0, 0.2}) {
    scenes.push_back({"bidirectional_point", "tukey", 0.0, outliers, kDefault});
    for (const double missing : {0.0, 0.25}) {
      scenes.push_back(
          {"bidirectional_image", "tukey", missing, outliers, kOther});
    }
    for (const char* cost : {"point_to_point", "mahalanobis_point",
                             "point_to_plane", "reprojection_depth"}) {
      scenes.push_back({cost, "tukey", 0.0, outliers, kOther});
    }
    for (const char* cost : {"reprojection", "reprojection_depth+epipolar"}) {
      scenes.push_back({cost, "tukey", 0.25, outliers, kOther});
    }
    scenes.push_back({"reprojection_depth+motion_prior", "tukey,none", 0.0,
                      outliers, kOther});
  }
  scenes.push_back(
      {"bidirectional_point+epipolar", "tukey", 0.25, 0.2, kOther});
  return scenes;
}

INSTANTIATE_TEST_SUITE_P(Costs, CovarianceTest, ::testing::ValuesIn(Scenes()),
                         SceneName);

// Matches, all inliers, whose noise differs between the two frames: in size or,
// through a wide baseline, in direction.
using UnequalNoise = std::tuple<const char*, const char*>;  // cost and scene
constexpr char kPixelNoise[] = "pixel_noise";  // 2 px against 0.5 px
constexpr char kBaseline[] = "baseline";       // 45 degrees, 2 m

Correspondences MatchesOf(const std::string& scene, int seed, Rigid3d* truth) {
  RandomWorld world(3000 + seed);
  const Camera camera;
  const bool is_wide = scene == kBaseline;
  *truth = world.Motion(0.05, 0.05);
  if (is_wide) {
    // Rotates about a point 2.6 m ahead, which stays at its place in the image.
    const Eigen::Vector3d ahead(0.0, 0.0, 2.6);
    truth->rotation = Eigen::AngleAxisd(M_PI / 4.0, Eigen::Vector3d::UnitY());
    truth->translation = ahead - truth->rotation * ahead;
  }
  Correspondences matches(camera);
  for (int i = 0; i < kCovarianceMatches; ++i) {
    Observation prev, cur;
    world.Match(camera, *truth, &prev, &cur);
    if (!is_wide) prev.sigma_px = 2.0;
    world.AddNoise(&prev);
    world.AddNoise(&cur);
    cur.normal = -world.Vector(1.0).cwiseAbs().normalized();
    matches.Add(prev, cur);
  }
  return matches;
}

class UnequalNoiseTest : public ::testing::TestWithParam<UnequalNoise> {};

// Checks the results given in docs/costs.md, starting from the truth.
TEST_P(UnequalNoiseTest, IsAsDocumented) {
  const auto& [cost, scene] = GetParam();
  constexpr int kSeeds = 300;
  Estimator estimator({}, MakeRobustCosts(cost, "tukey"));
  double nees = 0.0, inliers = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Rigid3d truth;
    const Correspondences matches = MatchesOf(scene, seed, &truth);
    const MotionEstimate estimate = estimator.Estimate(matches, truth);
    ASSERT_TRUE(estimate.ok()) << estimate.reason << ", seed " << seed;
    nees += Nees(estimate, truth) / kSeeds;
    inliers += 1.0 * estimate.num_inliers / estimate.num_used / kSeeds;
  }
  RecordProperty("nees", std::to_string(nees));
  RecordProperty("inlier_share", std::to_string(inliers));
  // One cost assumes that both frames are equally noisy.
  const bool is_equal = cost == std::string("bidirectional_point");
  const bool is_wide = scene == std::string(kBaseline);
  EXPECT_NEAR(nees, is_equal && !is_wide ? 9.2 : 6.0, kOther);
  EXPECT_NEAR(inliers, !is_equal ? 0.99 : (is_wide ? 0.785 : 0.68), 0.02);
}

INSTANTIATE_TEST_SUITE_P(
    Costs, UnequalNoiseTest,
    ::testing::Combine(::testing::Values("bidirectional_point",
                                         "bidirectional_image",
                                         "point_to_point", "mahalanobis_point",
                                         "point_to_plane", "reprojection",
                                         "reprojection_depth"),
                       ::testing::Values(kPixelNoise, kBaseline)),
    [](const auto& info) {
      return std::string(std::get<0>(info.param)) + "_" +
             std::get<1>(info.param);
    });

}  // namespace
}  // namespace rgbd_pose
