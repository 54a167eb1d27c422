#include "frontend/bags/transform_tree.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

Rigid3d Step(double x, double angle = 0.0) {
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
      {x, 0, 0}};
}

TEST(TransformTreeTest, FindsWhatIsFixedThroughACommonFrame) {
  TransformTree tree;
  tree.Add("world", "rig", 0, Step(1));
  tree.Add("world", "rig", 1, Step(2));
  tree.Add("rig", "a", 0, Step(1, M_PI / 2));
  tree.Add("rig", "b", 0, Step(3));
  tree.Add("b", "c", 0, Step(4));
  const auto a_from_c = tree.Fixed("a", "c");
  ASSERT_TRUE(a_from_c.has_value());
  EXPECT_LT((a_from_c->translation - Eigen::Vector3d(0, -6, 0)).norm(), 1e-12);
  EXPECT_FALSE(tree.Fixed("world", "a").has_value()) << "it moves";
  EXPECT_FALSE(tree.Fixed("a", "nowhere").has_value());
  EXPECT_TRUE(tree.Fixed("alone", "alone").has_value());
}

TEST(TransformTreeTest, PathGoesThroughAllThatMoves) {
  TransformTree tree;
  // The table moves rarely, the camera often; transforms come in any order.
  for (const double stamp : {4.0, 0.0, 2.0}) {
    tree.Add("world", "table", stamp, Step(stamp));
  }
  for (int k = 8; k >= -1; --k) {
    tree.Add("table", "camera", 0.5 * k, Step(100 * k));
  }
  tree.Add("camera", "lens", 0, Step(0.25));
  tree.Add("camera", "lens", 9, Step(0.25));
  const Trajectory path = tree.PathOf("world", "lens");
  ASSERT_EQ(path.size(), 9u) << "before 0 nobody knows where the table is";
  for (int k = 0; k <= 8; ++k) {
    EXPECT_EQ(path[k].timestamp, 0.5 * k);
    EXPECT_NEAR(path[k].world_from_cam.translation.x(),
                0.5 * k + 100 * k + 0.25, 1e-12);
  }
}

TEST(TransformTreeTest, HasNoPathWhereNothingMoves) {
  TransformTree tree;
  tree.Add("world", "camera", 0, Step(1));
  tree.Add("world", "camera", 1, Step(1));
  EXPECT_TRUE(tree.PathOf("world", "camera").empty());
  EXPECT_TRUE(tree.PathOf("map", "camera").empty());
}

TEST(TransformTreeTest, CirclesEnd) {
  TransformTree tree;
  tree.Add("a", "b", 0, Step(1));
  tree.Add("b", "a", 0, Step(1));
  EXPECT_FALSE(tree.Fixed("a", "c").has_value());
  EXPECT_TRUE(tree.PathOf("c", "a").empty());
}

}  // namespace
}  // namespace rgbd_pose
