#include "frontend/fusion/surface_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "frontend/fusion/voxel_key.h"

namespace rgbd_pose {
namespace {

constexpr double kVoxel = 0.02;                      // m
constexpr double kRadius = 0.3;                      // m
const Eigen::Vector3d kBallCentre(0.01, -0.2, 0.1);  // both signs

// A ball, known where `is_known` is true. Its inside is behind the surface.
template <typename IsKnown>
TsdfVolume Ball(const IsKnown& is_known) {
  constexpr int kSide = TsdfVolume::kSide;
  TsdfVolume volume;
  for (int b = 0; b < 512; ++b) {
    const Eigen::Vector3i at(b / 64 - 4, b / 8 % 8 - 4, b % 8 - 4);
    auto* block = volume.FindOrInsert(VoxelKey(at));
    for (int i = 0; i < TsdfVolume::kBlockSize; ++i) {
      const Eigen::Vector3i in_block(i / 64, i / 8 % 8, i % 8);
      const Eigen::Vector3d point =
          kVoxel * (kSide * at + in_block).cast<double>();
      DistanceVoxel& voxel = (*block)[i];
      voxel.distance =
          static_cast<float>((point - kBallCentre).norm() - kRadius);
      voxel.weight = is_known(point) ? 1.0F : 0.0F;
      voxel.color = {256 * 10, 256 * 20, 256 * 30};
    }
  }
  return volume;
}

TEST(SurfaceMeshTest, ABallIsClosedAndItsFrontOutside) {
  const TriangleMesh mesh = SurfaceMesh(
      Ball([](const Eigen::Vector3d&) { return true; }), kVoxel, 1.0F);
  std::map<std::pair<int, int>, int> edges;  // counts by direction
  double volume = 0.0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
    const auto at = [&](int i) -> Eigen::Vector3d {
      return mesh.vertices[t[i]].position.cast<double>() - kBallCentre;
    };
    volume += at(0).cross(at(1)).dot(at(2)) / 6.0;
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1);
  }
  // Positive: corners are counter-clockwise seen from outside. Chords reduce
  // the volume a little.
  EXPECT_NEAR(volume / (4.0 / 3.0 * M_PI * std::pow(kRadius, 3)), 1.0, 0.01);
  for (const ColoredPoint& vertex : mesh.vertices) {
    // The sagitta of a voxel's diagonal.
    EXPECT_NEAR((vertex.position.cast<double>() - kBallCentre).norm(), kRadius,
                kVoxel * kVoxel / kRadius / 2.0);
    EXPECT_THAT(vertex.color, testing::ElementsAre(10, 20, 30));
  }
}

TEST(SurfaceMeshTest, EndsWhereNothingIsKnown) {
  const TriangleMesh mesh = SurfaceMesh(
      Ball([](const Eigen::Vector3d& point) { return point.x() > 0.05; }),
      kVoxel, 1.0F);
  ASSERT_GT(mesh.triangles.size(), 500);
  for (const ColoredPoint& vertex : mesh.vertices) {
    EXPECT_GT(vertex.position.x(), 0.05F);
  }
  std::set<int> used;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    used.insert(triangle.begin(), triangle.end());
  }
  EXPECT_EQ(used.size(), mesh.vertices.size()) << "each is in a triangle";
  EXPECT_TRUE(SurfaceMesh(TsdfVolume(), kVoxel, 1.0F).vertices.empty());
}

// A piece of the surface that fits into one cube leaves no vertex behind.
TEST(SurfaceMeshTest, ThinHasOnlyVerticesOfTriangles) {
  TriangleMesh mesh = SurfaceMesh(
      Ball([](const Eigen::Vector3d&) { return true; }), kVoxel, 0.5F);
  const int first = static_cast<int>(mesh.vertices.size());
  constexpr float kSide = 1e-4F;  // m
  for (const auto& corner :
       {Eigen::Vector3f(0, 0, 0), {kSide, 0, 0}, {0, kSide, 0}}) {
    mesh.vertices.push_back({Eigen::Vector3f(1.01F, 1.01F, 1.01F) + corner});
  }
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  const TriangleMesh thin =
      SimplifyMesh(mesh, kVoxel, mesh.triangles.size() / 4);
  ASSERT_GT(thin.triangles.size(), 100u);
  std::set<int> used;
  for (const Eigen::Vector3i& triangle : thin.triangles) {
    used.insert(triangle.begin(), triangle.end());
  }
  EXPECT_EQ(used.size(), thin.vertices.size());
}

}  // namespace
}  // namespace rgbd_pose
