// Which matches each cost uses.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "costs/cost_factory.h"
#include "costs/matches/epipolar.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

Rigid3d Motion() { return RandomWorld(4).Motion(0.1, 0.3); }

// Match 0 has both depths, 1 only that of the previous frame, 2 only that of
// the current frame, 3 none; 4 has both but no normal.
Correspondences MatchesOfAllKinds() {
  RandomWorld world(3);
  const Correspondences whole = world.Matches(5, 0.0, Motion());
  Correspondences matches(whole.camera());
  for (int i = 0; i < 5; ++i) {
    Observation prev = whole[i].prev, cur = whole[i].cur;
    if (i == 2 || i == 3) prev.depth = 0.0;
    if (i == 1 || i == 3) cur.depth = 0.0;
    if (i == 4) cur.normal.setZero();
    matches.Add(prev, cur);
  }
  return matches;
}

const std::map<std::string, std::vector<int>>& UsedMatches() {
  static const auto& used = *new std::map<std::string, std::vector<int>>{
      {"bidirectional_point", {0, 4}}, {"bidirectional_image", {0, 1, 2, 4}},
      {"point_to_point", {0, 4}},      {"mahalanobis_point", {0, 4}},
      {"point_to_plane", {0}},         {"reprojection", {0, 1, 4}},
      {"reprojection_depth", {0, 4}},  {"epipolar", {1, 2, 3}},
      {"motion_prior", {-1}},
  };
  return used;
}

// A cost that is bound to these matches and a prior.
std::unique_ptr<MotionCost> BoundCost(const std::string& name) {
  static const auto& matches = *new Correspondences(MatchesOfAllKinds());
  static const MotionPrior prior{Rigid3d(), MotionMatrix::Identity()};
  std::unique_ptr<MotionCost> cost = MakeCost(name);
  cost->Bind({&matches, &prior});
  cost->Associate(Motion());
  return cost;
}

// With depth in one frame only, bidirectional_image has just u and v.
TEST(CostMatchesTest, EachCostTakesWhatItCanUseWithItsDegrees) {
  for (const std::string& name : CostNames()) {
    ASSERT_TRUE(UsedMatches().count(name)) << name << " is missing above";
    const auto cost = BoundCost(name);
    EXPECT_EQ(cost->matches(), UsedMatches().at(name)) << name;
    std::vector<int> degrees(cost->matches().size(),
                             cost->degrees_of_freedom());
    if (name == "bidirectional_image") degrees = {3, 2, 2, 3};
    EXPECT_EQ(cost->degrees(), degrees) << name;
  }
}

// An epipolar match needs a baseline that is visible from both rays, and rays
// that meet in front of both cameras.
TEST(CostMatchesTest, EpipolarNeedsABaselineAndAPointInFront) {
  const Camera camera;
  const double short_baseline = 0.9 * Epipolar::kMinBaseline;
  const auto uses = [&](double baseline, double depth) {
    // The current camera is to the right, so the point moves to the left.
    const Rigid3d motion(Eigen::Quaterniond::Identity(),
                         Eigen::Vector3d(-baseline, 0.0, 0.0));
    Observation prev, cur;
    prev.u = camera.cx;
    cur.u = camera.cx - camera.fx * baseline / depth;
    prev.v = cur.v = camera.cy;
    Correspondences matches(camera);
    matches.Add(prev, cur);
    const std::unique_ptr<MotionCost> cost = MakeCost("epipolar");
    cost->Bind({&matches});
    cost->Associate(motion);
    return !cost->matches().empty();
  };
  EXPECT_TRUE(uses(0.3, 2.0));
  EXPECT_TRUE(uses(0.3, 1e6));
  EXPECT_FALSE(uses(0.3, -2.0)) << "behind both cameras";
  EXPECT_TRUE(uses(0.3, -300.0)) << "at infinity, within the noise";
  EXPECT_FALSE(uses(0.3, 0.9 * Epipolar::kNearest));
  EXPECT_TRUE(uses(0.3, 2.0 * Epipolar::kNearest));
  EXPECT_TRUE(uses(0.03, 0.99 * Epipolar::kNearest)) << "within the noise";
  EXPECT_FALSE(uses(short_baseline, 2.0));
  EXPECT_FALSE(uses(0.0, 2.0));
}

// Costs keep no data of an earlier Bind().
TEST(CostMatchesTest, BindingToNothingLeavesNothing) {
  for (const std::string& name : CostNames()) {
    const auto cost = BoundCost(name);
    cost->Bind({});
    cost->Associate(Rigid3d());
    EXPECT_TRUE(cost->matches().empty()) << name;
    NormalEquations sum;
    const MotionVector zero = MotionVector::Zero();
    cost->Linearise(LinearizationPoint().DerivativesAt(zero.data()), nullptr,
                    &sum);
    EXPECT_EQ(sum.cost, 0.0) << name;
    EXPECT_TRUE(sum.hessian.isZero(0.0)) << name;
  }
}

}  // namespace
}  // namespace rgbd_pose
