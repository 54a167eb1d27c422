#include "frontend/fusion/surface_mesh.h"

#include <algorithm>
#include <cmath>

#include "frontend/fusion/voxel_key.h"

namespace rgbd_pose {
namespace {

constexpr int kSide = TsdfVolume::kSide;
constexpr int kNone = -1;

using Corners = std::array<DistanceVoxel, 8>;

// The place of a corner; the highest bit of the index is x.
Eigen::Vector3i CornerAt(int index) {
  return {index >> 2 & 1, index >> 1 & 1, index & 1};
}

void DropUnusedVertices(TriangleMesh* mesh) {
  std::vector<int> places(mesh->vertices.size(), kNone);
  for (const Eigen::Vector3i& triangle : mesh->triangles) {
    for (const int vertex : triangle) places[vertex] = 0;
  }
  int count = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    if (places[i] == kNone) continue;
    mesh->vertices[count] = mesh->vertices[i];
    places[i] = count++;
  }
  mesh->vertices.resize(count);
  for (Eigen::Vector3i& triangle : mesh->triangles) {
    for (int& vertex : triangle) vertex = places[vertex];
  }
}

class Mesher {
 public:
  Mesher(const TsdfVolume& volume, double voxel_size, float min_weight)
      : volume_(volume),
        voxel_size_(voxel_size),
        min_weight_(min_weight),
        vertices_(volume.size()) {}

  TriangleMesh Mesh() {
    for (int i = 0; i < volume_.size(); ++i) AddVertices(i);
    for (int i = 0; i < volume_.size(); ++i) AddTriangles(i);
    // At the ends of the surface, some voxels around edges are unknown.
    DropUnusedVertices(&mesh_);
    return std::move(mesh_);
  }

 private:
  // A block and its neighbours towards higher (sign 1) or lower (-1)
  // coordinates; kNone for missing blocks.
  std::array<int, 8> Neighbours(int index, int sign) const {
    const Eigen::Vector3i here = VoxelOfKey(volume_.key(index));
    std::array<int, 8> neighbours;
    for (int n = 0; n < 8; ++n) {
      neighbours[n] = volume_.Find(VoxelKey(here + sign * CornerAt(n)));
    }
    return neighbours;
  }

  void AddVertices(int index) {
    const std::array<int, 8> around = Neighbours(index, 1);
    const Eigen::Vector3i first = kSide * VoxelOfKey(volume_.key(index));
    Corners corners;
    for (int place = 0; place < TsdfVolume::kBlockSize; ++place) {
      const Eigen::Vector3i voxel = TsdfVolume::PointAt(place);
      bool known = true;
      int behind = 0;
      for (int c = 0; c < 8 && known; ++c) {
        const Eigen::Vector3i at = voxel + CornerAt(c);
        const Eigen::Vector3i block = at / kSide;
        const int n = around[block[0] << 2 | block[1] << 1 | block[2]];
        corners[c] = {};
        if (n != kNone) corners[c] = volume_.block(n)[TsdfVolume::PlaceOf(at)];
        known = corners[c].weight >= min_weight_;
        behind += corners[c].distance < 0.0F;
      }
      if (!known || behind == 0 || behind == 8) continue;
      if (vertices_[index].empty()) {
        vertices_[index].assign(TsdfVolume::kBlockSize, kNone);
      }
      vertices_[index][place] = static_cast<int>(mesh_.vertices.size());
      mesh_.vertices.push_back(Vertex(first + voxel, corners));
    }
  }

  ColoredPoint Vertex(const Eigen::Vector3i& voxel,
                      const Corners& corners) const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int crossed = 0;
    for (int c = 0; c < 8; ++c) {
      for (int axis = 0; axis < 3; ++axis) {
        const int other = c | 4 >> axis;
        const float a = corners[c].distance, b = corners[other].distance;
        if (other == c || (a < 0.0F) == (b < 0.0F)) continue;
        Eigen::Vector3f at = CornerAt(c).cast<float>();
        at[axis] += a / (a - b);
        sum += at;
        ++crossed;
      }
    }
    const Eigen::Vector3f at = sum / static_cast<float>(crossed);
    const Eigen::Vector3d position =
        voxel_size_ * (voxel.cast<double>() + at.cast<double>());
    return {position.cast<float>(), ColorAt(at, corners)};
  }

  // The mean colour of the corners, weighted by their weight and proximity.
  static std::array<uint8_t, 3> ColorAt(const Eigen::Vector3f& at,
                                        const Corners& corners) {
    std::array<float, 3> sum = {};
    float total = 0.0F;
    for (int c = 0; c < 8; ++c) {
      float share = corners[c].weight;
      for (int axis = 0; axis < 3; ++axis) {
        share *= CornerAt(c)[axis] == 1 ? at[axis] : 1.0F - at[axis];
      }
      for (int i = 0; i < 3; ++i) sum[i] += share * corners[c].color[i];
      total += share;
    }
    std::array<uint8_t, 3> mean;
    for (int i = 0; i < 3; ++i) {
      mean[i] = static_cast<uint8_t>(std::min(
          255.0F, std::round(sum[i] / (DistanceVoxel::kColorSteps * total))));
    }
    return mean;
  }

  // Each grid edge is shared by four voxels, whose vertices form a quad.
  void AddTriangles(int index) {
    if (vertices_[index].empty()) return;
    const std::array<int, 8> below = Neighbours(index, -1);
    const auto vertex_at = [&](const Eigen::Vector3i& voxel) {
      int neighbour = 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (voxel[axis] < 0) neighbour |= 4 >> axis;
      }
      const int n = below[neighbour];
      if (n == kNone || vertices_[n].empty()) return kNone;
      return vertices_[n][TsdfVolume::PlaceOf(voxel)];
    };
    const std::array<int, 8> beyond = Neighbours(index, 1);
    for (int place = 0; place < TsdfVolume::kBlockSize; ++place) {
      if (vertices_[index][place] == kNone) continue;
      const Eigen::Vector3i voxel = TsdfVolume::PointAt(place);
      const float here = volume_.block(index)[place].distance;
      for (int axis = 0; axis < 3; ++axis) {
        Eigen::Vector3i end = voxel;
        ++end[axis];
        // The block exists, because the voxel has a vertex and so all corners
        // are known.
        const TsdfVolume::Block& block =
            volume_.block(beyond[end[axis] == kSide ? 4 >> axis : 0]);
        const float there = block[TsdfVolume::PlaceOf(end)].distance;
        if ((here < 0.0F) == (there < 0.0F)) continue;
        Eigen::Vector3i b = Eigen::Vector3i::Zero(), c = b;
        b[(axis + 1) % 3] = 1;
        c[(axis + 2) % 3] = 1;
        // The quad is counter-clockwise as seen from the far end of the axis.
        AddQuad({vertex_at(voxel), vertex_at(voxel - b),
                 vertex_at(voxel - b - c), vertex_at(voxel - c)},
                /*is_seen_from_end=*/here < 0.0F);
      }
    }
  }

  void AddQuad(std::array<int, 4> corners, bool is_seen_from_end) {
    if (*std::min_element(corners.begin(), corners.end()) == kNone) return;
    if (!is_seen_from_end) std::swap(corners[1], corners[3]);
    const auto at = [&](int i) { return mesh_.vertices[corners[i]].position; };
    // Split the quad along the shorter diagonal.
    const int from =
        (at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm() ? 0 : 1;
    for (const int to : {from + 1, from + 2}) {
      mesh_.triangles.emplace_back(corners[from], corners[to],
                                   corners[(to + 1) % 4]);
    }
  }

  const TsdfVolume& volume_;
  const double voxel_size_;
  const float min_weight_;
  // The vertices of the voxels of each block; empty for a block without any.
  std::vector<std::vector<int>> vertices_;
  TriangleMesh mesh_;
};

// Sums over the vertices in a cube.
struct Cube {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  int count = 0;
};

TriangleMesh Coarser(const TriangleMesh& mesh, float size) {
  std::unordered_map<uint64_t, int> index;  // only for lookup
  std::vector<Cube> cubes;
  std::vector<int> cube_of;
  for (const ColoredPoint& vertex : mesh.vertices) {
    const uint64_t key =
        VoxelKey((vertex.position / size).array().floor().cast<int>());
    const int at =
        index.emplace(key, static_cast<int>(cubes.size())).first->second;
    if (at == static_cast<int>(cubes.size())) cubes.emplace_back();
    cubes[at].position += vertex.position.cast<double>();
    for (int i = 0; i < 3; ++i) cubes[at].color[i] += vertex.color[i];
    ++cubes[at].count;
    cube_of.push_back(at);
  }
  TriangleMesh coarse;
  for (const Cube& cube : cubes) {
    ColoredPoint& vertex = coarse.vertices.emplace_back();
    vertex.position = (cube.position / cube.count).cast<float>();
    for (int i = 0; i < 3; ++i) {
      vertex.color[i] =
          static_cast<uint8_t>(std::lround(cube.color[i] / cube.count));
    }
  }
  std::vector<std::array<int, 3>> triangles;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    std::array<int, 3> t = {cube_of[triangle[0]], cube_of[triangle[1]],
                            cube_of[triangle[2]]};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    // Identical triangles must begin with the same vertex.
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()),
                  triangles.end());
  for (const auto& t : triangles)
    coarse.triangles.emplace_back(t[0], t[1], t[2]);
  // Pieces of the surface within one or two cubes have no triangle left.
  DropUnusedVertices(&coarse);
  return coarse;
}

}  // namespace

TriangleMesh SurfaceMesh(const TsdfVolume& volume, double voxel_size,
                         float min_weight) {
  return Mesher(volume, voxel_size, min_weight).Mesh();
}

TriangleMesh SimplifyMesh(const TriangleMesh& mesh, float voxel_size,
                          size_t max_triangles) {
  TriangleMesh thin = mesh;
  float size = voxel_size;
  while (thin.triangles.size() > max_triangles) {
    // The number of triangles falls with the square of their size. kMore makes
    // the loop end even if this is not exactly true.
    constexpr float kMore = 1.05F;
    size *= kMore * std::sqrt(static_cast<float>(thin.triangles.size()) /
                              static_cast<float>(max_triangles));
    thin = Coarser(mesh, size);
  }
  return thin;
}

}  // namespace rgbd_pose
