// What an estimator does as a cost asks it to: levels, coarse to fine,
// association after every step, a scale of its own, shared information.

#include "core/estimation/motion_cost.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "core/estimation/estimator.h"
#include "costs/assembly/cost_of.h"
#include "costs/cost_factory.h"
#include "costs/direct/direct_cost.h"
#include "costs/direct/photometric.h"
#include "costs/direct_cost_factory.h"
#include "costs/matches/point_to_point.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/scale.h"
#include "tests/support/direct_pair.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

MotionEstimate Estimate(const EstimatorOptions& options,
                        std::vector<RobustCost> costs, const FramePair& pair) {
  MotionEstimate estimate;
  Estimator(options, std::move(costs)).Estimate(pair, Rigid3d(), &estimate);
  return estimate;
}

MotionEstimate EstimateByPixels(const DirectOptions& points,
                                const DirectPair& pair) {
  return Estimate({}, MakeDirectCosts("photometric", "none", points),
                  pair.data());
}

TEST(MotionCostTest, LevelsFindWhatTheFinestAloneDoesNot) {
  const DirectPair pair(SyntheticDataset(SmallImages()), 10, 16);
  DirectOptions points;
  const MotionEstimate estimate = EstimateByPixels(points, pair);
  EXPECT_TRUE(estimate.ok()) << estimate.reason;
  const MotionError off = ErrorOf(estimate.cur_from_prev, pair.cur_from_prev);
  EXPECT_LE(off.translation, 0.005);
  points.num_levels = 1;
  const MotionError off_at_finest =
      ErrorOf(EstimateByPixels(points, pair).cur_from_prev, pair.cur_from_prev);
  EXPECT_GT(off_at_finest.translation, 10.0 * off.translation);
}

// A cost that is bound again after every step, and counts how often it was.
struct Counted : PointToPoint {
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kEveryStep;
  static inline int associations = 0;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    if (i == 0) ++associations;
    return PointToPoint::Pack(input, i, columns);
  }
};

TEST(MotionCostTest, IsAssociatedAfterEveryStep) {
  RandomWorld world(1);
  const Correspondences matches =
      world.Matches(100, 0.1, world.Motion(0.2, 0.2));
  std::vector<RobustCost> costs;
  costs.push_back({MakeCost<Counted>(), nullptr});
  const MotionEstimate estimate = Estimate({}, std::move(costs), {&matches});
  EXPECT_GT(estimate.iterations, 2);
  EXPECT_GT(Counted::associations, estimate.iterations);
}

// Its sigmas are a quarter of what they should be.
struct Overconfident : Photometric {
  static constexpr double kFactor = 4.0;

  template <typename D>
  [[gnu::always_inline]] static void LookUp(const DirectInput& input,
                                            const D* point, const D* samples,
                                            D* columns, D* rejection) {
    Photometric::LookUp(input, point, samples, columns, rejection);
    for (int k = 3; k < kColumns; ++k) columns[k] *= kFactor;
  }
};

// The same, as if the scale of its sigmas were that of matches.
struct OfOneScale : Overconfident {
  static constexpr int kScaleGroup = 0;
};

// The noise of gray levels is four times the model's; that of matches is right.
TEST(MotionCostTest, EachGroupHasItsOwnScale) {
  const DirectPair pair(SyntheticDataset(SmallImages()), 10, 12);
  const Correspondences matches =
      RandomWorld(3).Matches(60, 0.0, pair.cur_from_prev);
  FramePair data = pair.data();
  data.matches = &matches;
  EstimatorOptions options;
  options.scale = MadScale;
  const auto estimate = [&](std::unique_ptr<MotionCost> pixels) {
    std::vector<RobustCost> costs =
        MakeRobustCosts("mahalanobis_point", "none");
    costs.push_back({std::move(pixels), nullptr});
    return Estimate(options, std::move(costs), data);
  };
  DirectOptions points;
  points.max_points = 300;  // no more than matches can outweigh
  const MotionEstimate right =
      estimate(std::make_unique<DirectCostOf<Photometric>>(points));
  const MotionEstimate apart =
      estimate(std::make_unique<DirectCostOf<Overconfident>>(points));
  const MotionEstimate together =
      estimate(std::make_unique<DirectCostOf<OfOneScale>>(points));
  EXPECT_TRUE(apart.ok()) << apart.reason;
  const double off =
      ErrorOf(apart.cur_from_prev, right.cur_from_prev).translation;
  EXPECT_LE(off, 5e-5);
  EXPECT_GT(ErrorOf(together.cur_from_prev, right.cur_from_prev).translation,
            10.0 * off);
  for (int i = 0; i < 6; ++i) {
    const double ratio = apart.covariance(i, i) / right.covariance(i, i);
    EXPECT_NEAR(ratio, 1.0, 0.05) << i;
  }
}

TEST(MotionCostTest, InformationFactorDividesTheCovariance) {
  const DirectPair pair(SyntheticDataset(SmallImages()), 10, 12);
  DirectOptions points;
  points.finest_level = 0;  // thousands of pixels
  points.information_factor = 1.0;
  const MotionEstimate all = EstimateByPixels(points, pair);
  points.information_factor = 0.25;
  const MotionEstimate quarter = EstimateByPixels(points, pair);
  EXPECT_LE(ErrorOf(all.cur_from_prev, quarter.cur_from_prev).translation,
            1e-5);
  for (int i = 0; i < 6; ++i) {
    const double ratio = quarter.covariance(i, i) / all.covariance(i, i);
    EXPECT_NEAR(ratio, 4.0, 0.05) << i;
  }
}

}  // namespace
}  // namespace rgbd_pose
