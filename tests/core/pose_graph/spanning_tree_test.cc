// The tree of a pose graph, and where its edges put the poses.

#include "core/pose_graph/spanning_tree.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/factors/sampler.h"

namespace rgbd_pose {
namespace {

// Pose 2 is fixed; edges lead from it to 0 and 1, and from 1 to 3, some of them
// against their direction. Only pose 2 is where it should be.
struct Branches {
  std::vector<Rigid3d> truth;
  GraphTerms graph;

  Branches() {
    FactorSampler random(1);
    for (int i = 0; i < 4; ++i) {
      truth.push_back(random.Motion());
      graph.poses.push_back({i == 2 ? truth[2] : random.Motion(), i == 2});
    }
    Add(3, 1);
    Add(2, 1);
    Add(0, 2);
  }

  void Add(int ref, int cur) {
    GraphTerms::Edge edge;
    edge.ref = ref;
    edge.cur = cur;
    edge.cur_from_ref = truth[cur].Inverse() * truth[ref];
    edge.root.setIdentity();
    graph.edges.push_back(edge);
  }
};

TEST(SpanningTreeTest, ExactEdgesPutPosesWhereTheyAre) {
  constexpr double kRounding = 1e-14;  // m and rad
  const Branches branches;
  const auto tree = SpanningTree(branches.graph, {true, true, true});
  EXPECT_EQ(FirstOutside(tree, branches.graph), -1);
  ASSERT_EQ(tree.size(), 4U);
  EXPECT_EQ(tree.front().pose, 2);
  EXPECT_EQ(tree.back().pose, 3);
  const auto poses = PosesByTree(tree, branches.graph);
  for (int i = 0; i < 4; ++i) {
    const Rigid3d off = branches.truth[i].Inverse() * poses[i].world_from_cam;
    EXPECT_LT(off.translation.norm(), kRounding) << i;
    EXPECT_LT(off.Angle(), kRounding) << i;
  }
}

TEST(SpanningTreeTest, EdgesThatAreNotUsableLeadNowhere) {
  const Branches branches;
  const auto tree = SpanningTree(branches.graph, {true, false, true});
  EXPECT_EQ(FirstOutside(tree, branches.graph), 1);
  EXPECT_EQ(tree.size(), 2U);
}

}  // namespace
}  // namespace rgbd_pose
