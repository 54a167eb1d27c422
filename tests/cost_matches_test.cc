// Which matches each cost takes in.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/cost.h"
#include "costs/cost_factory.h"
#include "tests/random_motion.h"

namespace rgbd_pose {
namespace {

// Match 0 has both depths, 1 that of the previous frame, 2 that of the current
// frame, 3 none; 4 has both and no normal.
Correspondences MatchesOfAllKinds() {
  RandomWorld world(3);
  const Correspondences whole = world.Matches(5, 0.0, Rigid3d());
  Correspondences matches(whole.camera());
  for (int i = 0; i < 5; ++i) {
    Observation prev = whole.prev()[i], cur = whole.cur()[i];
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

TEST(CostMatchesTest, EachCostTakesWhatItCanUse) {
  const Correspondences matches = MatchesOfAllKinds();
  const MotionPrior prior;
  for (const std::string& name : CostNames()) {
    const std::unique_ptr<Cost> cost = MakeCost(name);
    ASSERT_TRUE(UsedMatches().count(name)) << name << " is missing above";
    cost->Bind({matches, Rigid3d(), &prior});
    EXPECT_EQ(cost->matches(), UsedMatches().at(name)) << name;
  }
}

// Costs keep nothing of what they were bound to before.
TEST(CostMatchesTest, BindingToNothingLeavesNothing) {
  const Correspondences matches = MatchesOfAllKinds();
  const MotionPrior prior;
  for (const std::string& name : CostNames()) {
    const std::unique_ptr<Cost> cost = MakeCost(name);
    cost->Bind({matches, Rigid3d(), &prior});
    cost->Bind({Correspondences(), Rigid3d()});
    EXPECT_TRUE(cost->matches().empty()) << name;
    NormalEquations sum;
    const MotionVector zero = MotionVector::Zero();
    cost->Linearise(MotionOrigin().DerivativesAt(zero.data()), nullptr, &sum);
    EXPECT_EQ(sum.cost, 0.0) << name;
    EXPECT_TRUE(sum.hessian.isZero(0.0)) << name;
  }
}

}  // namespace
}  // namespace rgbd_pose
