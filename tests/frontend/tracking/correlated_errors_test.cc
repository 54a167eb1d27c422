#include "frontend/tracking/correlated_errors.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/estimation/estimator.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr int kTrials = 60;

struct Consistency {
  double factor = 0.0;     // mean
  double nees = 0.0;       // of the covariance as estimated
  double corrected = 0.0;  // of the covariance times the factor
};

// Matches have independent noise, or noise of which a part is the same in each
// cell of 80 x 80 px.
Consistency Measure(double independent, double shared) {
  Estimator estimator({}, MakeRobustCosts());
  Consistency sum;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomWorld world(trial);
    const Rigid3d motion = world.Motion(0.05, 0.05);
    const Camera camera;
    Correspondences matches(camera);
    std::vector<Eigen::Vector2d> offsets;
    for (int cell = 0; cell < 8 * 6; ++cell) {
      const double u = world.Normal(shared);
      offsets.emplace_back(u, world.Normal(shared));
    }
    for (int i = 0; i < 300; ++i) {
      Observation prev, cur;
      world.Match(camera, motion, &prev, &cur);
      const int cell =
          static_cast<int>(cur.v / 80.0) * 8 + static_cast<int>(cur.u / 80.0);
      if (!camera.Contains({cur.u, cur.v})) continue;
      cur.u += offsets[cell].x() + world.Normal(independent * cur.sigma_px);
      cur.v += offsets[cell].y() + world.Normal(independent * cur.sigma_px);
      prev.u += world.Normal(independent * prev.sigma_px);
      prev.v += world.Normal(independent * prev.sigma_px);
      cur.depth += world.Normal(independent * cur.sigma_depth);
      prev.depth += world.Normal(independent * prev.sigma_depth);
      matches.Add(prev, cur);
    }
    const MotionEstimate estimate = estimator.Estimate(matches, motion);
    EXPECT_TRUE(estimate.ok()) << estimate.reason;
    const double factor = CovarianceInflation(matches, estimate);
    EXPECT_GE(factor, 1.0);
    const double square = SquaredMahalanobisDistance(
        motion, estimate.cur_from_prev, estimate.covariance);
    sum.factor += factor / kTrials;
    sum.nees += square / 6.0 / kTrials;
    sum.corrected += square / factor / 6.0 / kTrials;
  }
  return sum;
}

TEST(CorrelatedErrorsTest, IndependentErrorsChangeNothing) {
  for (const double size : {0.5, 1.0}) {
    const Consistency found = Measure(size, 0.0);
    EXPECT_LT(found.factor, 1.05) << size;
    EXPECT_NEAR(found.nees, 1.0, 0.3) << size;
  }
}

TEST(CorrelatedErrorsTest, ErrorsAlikeInNeighboursMakeTheMotionLessCertain) {
  const Consistency found = Measure(0.5, 0.7);
  EXPECT_GT(found.factor, 2.0);
  EXPECT_GT(found.nees, 2.0);
  EXPECT_NEAR(found.corrected, 1.0, 0.5);
}

TEST(CorrelatedErrorsTest, NothingIsKnownWithoutMatches) {
  const Camera camera;
  EXPECT_EQ(CovarianceInflation(Correspondences(camera), MotionEstimate()),
            1.0);
}

}  // namespace
}  // namespace rgbd_pose
