#include <gtest/gtest.h>

#include <algorithm>

#include "frontend/slam/keyframe_graph.h"

namespace rgbd_pose {
namespace {

using Numbers = std::vector<int>;

// 0 - 1 - 2 - ... - 9
CovisibilityGraph Chain() {
  CovisibilityGraph links;
  for (int i = 0; i < 10; ++i) {
    links.Add();
    if (i > 0) links.Join(i - 1, i);
  }
  return links;
}

TEST(CovisibilityGraphTest, HopsCountLinks) {
  const CovisibilityGraph links = Chain();
  EXPECT_TRUE(links.Within(3, 0)[3]);
  EXPECT_TRUE(links.Within(3, 4)[7]);
  EXPECT_FALSE(links.Within(3, 3)[7]);
  const std::vector<bool> near = links.Within(3, 2);
  EXPECT_EQ(std::count(near.begin(), near.end(), true), 5);
  EXPECT_TRUE(near[1] && near[5]);
  EXPECT_TRUE(links.AreJoined(3, 4));
  EXPECT_FALSE(links.AreJoined(3, 5));
}

TEST(CovisibilityGraphTest, AWayHasTheFewestLinks) {
  CovisibilityGraph links = Chain();
  EXPECT_EQ(links.ShortestPath(6, 3), Numbers({6, 5, 4, 3}));
  EXPECT_EQ(links.ShortestPath(4, 4), Numbers({4}));
  links.Join(2, 8);
  EXPECT_EQ(links.ShortestPath(1, 9), Numbers({1, 2, 8, 9}));
  links.Add();
  EXPECT_EQ(links.ShortestPath(1, 10), Numbers());
}

TEST(CovisibilityGraphTest, ThoseBesideOneMayHoldWithoutIt) {
  CovisibilityGraph links = Chain();
  EXPECT_TRUE(links.StaysConnectedWithout(9));
  EXPECT_FALSE(links.StaysConnectedWithout(5));
  links.Join(4, 6);
  EXPECT_TRUE(links.StaysConnectedWithout(5));
  links.Separate(5);
  EXPECT_TRUE(links.Neighbors(5).empty());
  EXPECT_FALSE(links.AreJoined(4, 5));
  EXPECT_EQ(links.ShortestPath(3, 7), Numbers({3, 4, 6, 7}));
}

}  // namespace
}  // namespace rgbd_pose
