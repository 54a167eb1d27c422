#include "frontend/fusion/voxel_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/util/counter_random.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3f;

ColoredPoint Point(float x, float y, float z, int gray = 0) {
  const auto value = static_cast<uint8_t>(gray);
  return {Vector3f(x, y, z), {value, value, value}};
}

// A float of a few metres is exact to 2e-7 m; sums of a few points to this.
constexpr float kTolerance = 2e-6F;

// Points of a slanted square plate, 4 m wide; some share a voxel.
std::vector<ColoredPoint> Plate(int side) {
  std::vector<ColoredPoint> points;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const float x = 4.0F * i / side - 2.0F;
      const float y = 4.0F * j / side - 2.0F;
      points.push_back(Point(x, y, 0.3F * x + 2.0F, (i + j) % 256));
    }
  }
  return points;
}

TEST(VoxelCloudTest, MergesPointsOfACubeToTheirMean) {
  VoxelCloud cloud(0.1F);
  ColoredPoint red = Point(1.01F, -0.02F, 2.03F);
  red.color[0] = 200;
  ColoredPoint blue = Point(1.05F, -0.06F, 2.09F);
  blue.color[2] = 101;
  cloud.Add(red);
  cloud.Add(blue);
  cloud.Add(Point(1.11F, -0.02F, 2.03F, 50));  // the next voxel
  const std::vector<ColoredPoint> points = cloud.Points();
  ASSERT_EQ(points.size(), 2u);
  EXPECT_LT((points[0].position - Vector3f(1.03F, -0.04F, 2.06F)).norm(),
            kTolerance);
  EXPECT_THAT(points[0].color, testing::ElementsAre(100, 0, 51));  // rounded
  EXPECT_LT((points[1].position - Vector3f(1.11F, -0.02F, 2.03F)).norm(),
            kTolerance);
  EXPECT_EQ(points[1].color[1], 50);
}

TEST(VoxelCloudTest, MillionsOfPointsOfACubeKeepTheirMean) {
  VoxelCloud cloud(1.0F);
  for (int i = 0; i < 20000000; ++i) cloud.Add(Point(0.9F, 0.9F, 0.9F, 255));
  const ColoredPoint mean = cloud.Points()[0];
  EXPECT_EQ(mean.color[0], 255);
  EXPECT_NEAR(mean.position.x(), 0.9F, 0.01F);
}

// Compares with a std::map of the cubes alone, without blocks.
TEST(VoxelCloudTest, CountsTheCubesThatAMapCounts) {
  constexpr int kPoints = 200000;
  constexpr float kSize = 0.0625F;  // no rounding in x / kSize
  VoxelCloud cloud(kSize);
  std::map<std::tuple<int, int, int>, int> cubes;
  CounterRandom random(1);
  for (int i = 0; i < kPoints; ++i) {
    Vector3f x;
    for (int k = 0; k < 3; ++k) {
      x[k] = static_cast<float>(random.Below(8000)) / 1000.0F - 4.0F;
    }
    const auto cell = [&x](int k) {
      return static_cast<int>(std::floor(x[k] / kSize));
    };
    ++cubes[{cell(0), cell(1), cell(2)}];
    cloud.Add(Point(x[0], x[1], x[2]));
  }
  ASSERT_EQ(cloud.size(), static_cast<int>(cubes.size()));
  for (const ColoredPoint& point : cloud.Points()) {
    const auto cell = [&point](int k) {
      return static_cast<int>(std::floor(point.position[k] / kSize));
    };
    EXPECT_EQ(cubes.erase({cell(0), cell(1), cell(2)}), 1u);
  }
  EXPECT_TRUE(cubes.empty());
}

TEST(VoxelCloudTest, LeavesOutWhatIsNoPlace) {
  VoxelCloud cloud(0.01F);
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {inf, -inf, nan, 1e9F, -20000.0F, 20000.0F}) {
    cloud.Add(Point(bad, 0.0F, 0.0F));
    cloud.Add(Point(0.0F, 0.0F, bad));
  }
  EXPECT_EQ(cloud.size(), 0);
  EXPECT_TRUE(cloud.Points().empty());
  EXPECT_TRUE(cloud.Thin(10).empty());
  cloud.Add(Point(10000.0F, -10000.0F, 0.0F));  // 10^6 voxels away
  EXPECT_EQ(cloud.size(), 1);
}

TEST(VoxelCloudTest, ThinsEvenlyToAtMostWhatIsAskedFor) {
  VoxelCloud cloud(0.01F);
  for (const ColoredPoint& point : Plate(400)) cloud.Add(point);
  ASSERT_GT(cloud.size(), 100000);
  for (const int max_points : {8, 100, 1000, 30000}) {
    SCOPED_TRACE(max_points);
    const std::vector<ColoredPoint> thin = cloud.Thin(max_points);
    EXPECT_LE(thin.size(), static_cast<size_t>(max_points));
    // Voxels grow only until there are few enough points; the last step may
    // remove more than needed.
    EXPECT_GE(thin.size(), static_cast<size_t>(max_points) / 4);
    int left = 0;
    for (const ColoredPoint& point : thin) {
      left += point.position.x() < 0.0F;
      // Means of points on a plane are on the plane.
      EXPECT_NEAR(point.position.z(), 0.3F * point.position.x() + 2.0F, 1e-5F);
    }
    if (max_points >= 1000) {
      EXPECT_NEAR(static_cast<double>(left) / thin.size(), 0.5, 0.05);
    }
  }
  EXPECT_EQ(cloud.Thin(cloud.size()).size(), cloud.Points().size());
}

}  // namespace
}  // namespace rgbd_pose
