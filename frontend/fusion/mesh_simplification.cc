#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "frontend/fusion/surface_mesh.h"
#include "frontend/fusion/voxel_key.h"

namespace rgbd_pose {
namespace {

// Sums of what a cube holds.
struct Cube {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  int count = 0;
};

uint64_t KeyOf(const Eigen::Vector3f& position, float size) {
  return VoxelKey((position / size).array().floor().cast<int>());
}

uint8_t Round(double value) { return static_cast<uint8_t>(std::lround(value)); }

TriangleMesh Coarser(const TriangleMesh& mesh, float size) {
  std::unordered_map<uint64_t, int> index;  // for looking up alone
  std::vector<Cube> cubes;
  std::vector<int> cube_of;
  for (const ColoredPoint& vertex : mesh.vertices) {
    const int at = index
                       .emplace(KeyOf(vertex.position, size),
                                static_cast<int>(cubes.size()))
                       .first->second;
    if (at == static_cast<int>(cubes.size())) cubes.emplace_back();
    cubes[at].position += vertex.position.cast<double>();
    cubes[at].color += Eigen::Vector3d(vertex.red, vertex.green, vertex.blue);
    ++cubes[at].count;
    cube_of.push_back(at);
  }
  TriangleMesh coarse;
  for (const Cube& cube : cubes) {
    const Eigen::Vector3d color = cube.color / cube.count;
    coarse.vertices.push_back({(cube.position / cube.count).cast<float>(),
                               Round(color[0]), Round(color[1]),
                               Round(color[2])});
  }
  std::vector<std::array<int, 3>> triangles;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    std::array<int, 3> t = {cube_of[triangle[0]], cube_of[triangle[1]],
                            cube_of[triangle[2]]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    // The same triangle always begins with the same vertex.
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()),
                  triangles.end());
  for (const auto& t : triangles)
    coarse.triangles.emplace_back(t[0], t[1], t[2]);
  return coarse;
}

}  // namespace

TriangleMesh SimplifyMesh(const TriangleMesh& mesh, float voxel_size,
                          size_t max_triangles) {
  TriangleMesh thin = mesh;
  float size = voxel_size;
  while (thin.triangles.size() > max_triangles) {
    // The number of triangles falls with the square of their size. A little
    // more, so that it ends where that is not quite so.
    constexpr float kMore = 1.05F;
    size *= kMore * std::sqrt(static_cast<float>(thin.triangles.size()) /
                              static_cast<float>(max_triangles));
    thin = Coarser(mesh, size);
  }
  return thin;
}

}  // namespace rgbd_pose
