#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "frontend/fusion/triangle_mesh.h"

namespace rgbd_pose {

// The data at a corner of voxels.
struct DistanceVoxel {
  float distance = 0.0F;               // to the surface, m; > 0 in front of it
  float weight = 0.0F;                 // 1 / m^2; 0: no data
  std::array<uint16_t, 3> color = {};  // red, green, blue, in 1/256
};

// Distances to a surface on a grid, stored in sparse blocks: memory grows with
// the area of the surface. Grid points are at integer multiples of the voxel
// size from the origin, up to 2^20 blocks away.
class TsdfVolume {
 public:
  // Layout of a block: z is the fastest index, then y, then x.
  static constexpr int kSide = 8;
  static constexpr int kBlockSize = kSide * kSide * kSide;
  using Block = std::array<DistanceVoxel, kBlockSize>;
  static int PlaceOf(const Eigen::Vector3i& point) {
    return (point.x() * kSide + point.y()) * kSide + point.z();
  }
  static Eigen::Vector3i PointAt(int place) {
    return {place / (kSide * kSide), place / kSide % kSide, place % kSide};
  }

  // The block of a key (voxel_key.h), created if missing. The pointer stays
  // valid.
  Block* FindOrInsert(uint64_t key) {
    const auto [place, is_new] = index_.emplace(key, size());
    if (is_new) {
      keys_.push_back(key);
      blocks_.push_back(std::make_unique<Block>());
    }
    return blocks_[place->second].get();
  }

  // The number of blocks, and access to them in the order of their creation.
  int size() const { return static_cast<int>(blocks_.size()); }
  uint64_t key(int index) const { return keys_[index]; }
  const Block& block(int index) const { return *blocks_[index]; }

  // The index of the block of a key, or -1.
  int Find(uint64_t key) const {
    const auto place = index_.find(key);
    return place == index_.end() ? -1 : place->second;
  }

  // Memory used by the blocks, bytes.
  size_t MemoryBytes() const { return blocks_.size() * sizeof(Block); }

 private:
  std::vector<uint64_t> keys_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::unordered_map<uint64_t, int> index_;  // only for lookup
};

// The surface in a volume: the zero level of the distance. Each voxel that it
// passes gets a vertex, the mean of the surface's crossings of the voxel's
// edges. Each crossed edge gets two triangles (surface nets; S. F. F. Gibson,
// Constrained Elastic Surface Nets, MICCAI 1998). The surface ends where a
// corner's weight is less than `min_weight` (> 0). `voxel_size` in metres.
TriangleMesh SurfaceMesh(const TsdfVolume& volume, double voxel_size,
                         float min_weight);

// Simplifies a surface to at most `max_triangles` (> 0) triangles. Vertices in
// the same cube are merged, and degenerate triangles are removed. The size of
// cubes grows from `voxel_size` (m) until the limit is met.
TriangleMesh SimplifyMesh(const TriangleMesh& mesh, float voxel_size,
                          size_t max_triangles);

}  // namespace rgbd_pose
