// Monte Carlo: does the covariance of an estimate say how far off it is?

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <ostream>
#include <string>

#include "core/estimation/estimator.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr int kTrials = 500;
constexpr int kMatches = 250;
constexpr double kPriorSigma = 0.002;  // rad, m: about what matches tell

struct Scene {
  const char* costs;
  const char* losses;
  double missing_depth_share;
  double outlier_share;
  double tolerance;  // of the mean of six; its own sigma is 0.15
};

std::ostream& operator<<(std::ostream& out, const Scene& scene) {
  return out << scene.costs << ", outliers " << scene.outlier_share
             << ", missing depths " << scene.missing_depth_share;
}

// R_true = Exp(omega) R, and C (MotionEstimate::covariance).
MotionVector ErrorOf(const Rigid3d& estimate, const Rigid3d& truth) {
  const Eigen::AngleAxisd omega(truth.rotation * estimate.rotation.inverse());
  MotionVector error;
  error << omega.angle() * omega.axis(),
      truth.Inverse().translation - estimate.Inverse().translation;
  return error;
}

class CovarianceTest : public ::testing::TestWithParam<Scene> {};

// Normalised estimation error squared: d^T covariance^-1 d has a mean of 6 if
// the covariance says the truth. Costs that tell a measurement twice are a trap
// here: taken naively they count it twice.
TEST_P(CovarianceTest, IsHonest) {
  const Scene& scene = GetParam();
  Estimator estimator({}, MakeRobustCosts(scene.costs, scene.losses));
  double nees = 0.0;
  for (int seed = 0; seed < kTrials; ++seed) {
    RandomWorld world(1000 + seed);
    const Rigid3d truth = world.Motion(0.05, 0.05);
    const Correspondences matches =
        world.Matches(kMatches, scene.outlier_share, truth, /*noise=*/true,
                      scene.missing_depth_share);
    const MotionPrior prior = world.Prior(truth, kPriorSigma);
    const MotionEstimate estimate =
        estimator.Estimate(matches, Rigid3d(), &prior);
    ASSERT_TRUE(estimate.ok()) << estimate.reason << ", seed " << seed;
    const MotionVector error = ErrorOf(estimate.cur_from_prev, truth);
    nees += error.dot(estimate.covariance.ldlt().solve(error));
  }
  RecordProperty("nees", std::to_string(nees / kTrials));
  EXPECT_NEAR(nees / kTrials, 6.0, scene.tolerance);
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

constexpr double kDefault = 0.6;  // 10 %: of the cost that is the default
constexpr double kOther = 1.5;    // 25 %

INSTANTIATE_TEST_SUITE_P(
    Costs, CovarianceTest,
    ::testing::Values(
        Scene{"bidirectional_point", "tukey", 0.0, 0.0, kDefault},
        Scene{"bidirectional_point", "tukey", 0.0, 0.2, kDefault},
        Scene{"bidirectional_image", "tukey", 0.0, 0.0, kOther},
        Scene{"bidirectional_image", "tukey", 0.0, 0.2, kOther},
        Scene{"bidirectional_image", "tukey", 0.25, 0.0, kOther},
        Scene{"bidirectional_image", "tukey", 0.25, 0.2, kOther},
        Scene{"point_to_point", "tukey", 0.0, 0.0, kOther},
        Scene{"point_to_point", "tukey", 0.0, 0.2, kOther},
        Scene{"mahalanobis_point", "tukey", 0.0, 0.0, kOther},
        Scene{"mahalanobis_point", "tukey", 0.0, 0.2, kOther},
        Scene{"point_to_plane", "tukey", 0.0, 0.0, kOther},
        Scene{"point_to_plane", "tukey", 0.0, 0.2, kOther},
        Scene{"reprojection", "tukey", 0.25, 0.0, kOther},
        Scene{"reprojection", "tukey", 0.25, 0.2, kOther},
        Scene{"reprojection_depth", "tukey", 0.0, 0.0, kOther},
        Scene{"reprojection_depth", "tukey", 0.0, 0.2, kOther},
        // Epipolar matches fill in where a depth is missing.
        Scene{"reprojection_depth+epipolar", "tukey", 0.25, 0.0, kOther},
        Scene{"reprojection_depth+epipolar", "tukey", 0.25, 0.2, kOther},
        Scene{"bidirectional_point+epipolar", "tukey", 0.25, 0.2, kOther},
        Scene{"reprojection_depth+motion_prior", "tukey,none", 0.0, 0.0,
              kOther},
        Scene{"reprojection_depth+motion_prior", "tukey,none", 0.0, 0.2,
              kOther}),
    SceneName);

}  // namespace
}  // namespace rgbd_pose
