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
  tree.Add({{{0, "world"}, "rig", Step(1)}});
  tree.Add({{{1, "world"}, "rig", Step(2)}});
  tree.Add({{{0, "rig"}, "a", Step(1, M_PI / 2)}});
  tree.Add({{{0, "rig"}, "b", Step(3)}});
  tree.Add({{{0, "b"}, "c", Step(4)}});
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
    tree.Add({{{stamp, "world"}, "table", Step(stamp)}});
  }
  for (int k = 8; k >= -1; --k) {
    tree.Add({{{0.5 * k, "table"}, "camera", Step(100 * k)}});
  }
  tree.Add({{{0, "camera"}, "lens", Step(0.25)}});
  tree.Add({{{9, "camera"}, "lens", Step(0.25)}});
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
  tree.Add({{{0, "world"}, "camera", Step(1)}});
  tree.Add({{{1, "world"}, "camera", Step(1)}});
  EXPECT_TRUE(tree.PathOf("world", "camera").empty());
  EXPECT_TRUE(tree.PathOf("map", "camera").empty());
}

TEST(TransformTreeTest, CirclesEnd) {
  TransformTree tree;
  tree.Add({{{0, "a"}, "b", Step(1)}});
  tree.Add({{{0, "b"}, "a", Step(1)}});
  EXPECT_FALSE(tree.Fixed("a", "c").has_value());
  EXPECT_TRUE(tree.PathOf("c", "a").empty());
}

}  // namespace
}  // namespace rgbd_pose
