#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "frontend/fusion/mesh_file.h"

namespace rgbd_pose {

// The data at a corner of voxels.
struct DistanceVoxel {
  static constexpr float kColorSteps = 256.0F;  // of colours in fixed point

  float distance = 0.0F;               // to the surface, m; > 0 in front of it
  float weight = 0.0F;                 // 1 / m^2; 0: no data
  std::array<uint16_t, 3> color = {};  // red, green, blue, in 1/kColorSteps
};

// Distances to a surface in sparse blocks of a grid. Grid points are at integer
// multiples of the voxel size from the origin, up to 2^20 blocks away.
class TsdfVolume {
 public:
  // Layout of a block: z is the fastest index, then y, then x.
  static constexpr int kSide = 8;
  static constexpr int kBlockSize = kSide * kSide * kSide;
  using Block = std::array<DistanceVoxel, kBlockSize>;
  // The place in its block of a grid point, whatever block it is in.
  static int PlaceOf(const Eigen::Vector3i& point) {
    constexpr int kMask = kSide - 1;
    return ((point.x() & kMask) * kSide + (point.y() & kMask)) * kSide +
           (point.z() & kMask);
  }
  static Eigen::Vector3i PointAt(int place) {
    return {place / (kSide * kSide), place / kSide % kSide, place % kSide};
  }

  // The block of a key (voxel_key.h), created if missing; stays in place.
  Block* FindOrInsert(uint64_t key) {
    const auto [place, is_new] = index_.emplace(key, size());
    if (is_new) blocks_.emplace_back(key, std::make_unique<Block>());
    return blocks_[place->second].second.get();
  }

  // The number of blocks, and access to them in the order of their creation.
  int size() const { return static_cast<int>(blocks_.size()); }
  uint64_t key(int index) const { return blocks_[index].first; }
  const Block& block(int index) const { return *blocks_[index].second; }

  int Find(uint64_t key) const {  // -1: none
    const auto place = index_.find(key);
    return place == index_.end() ? -1 : place->second;
  }

 private:
  std::vector<std::pair<uint64_t, std::unique_ptr<Block>>> blocks_;
  std::unordered_map<uint64_t, int> index_;  // only for lookup
};

// The surface in a volume: the zero level of the distance. Each voxel that it
// passes gets a vertex, the mean of the surface's crossings of the voxel's
// edges. Each crossed edge gets two triangles (surface nets; S. F. F. Gibson,
// Constrained Elastic Surface Nets, MICCAI 1998). The surface ends where a
// corner's weight is less than `min_weight` (> 0). `voxel_size` in metres.
TriangleMesh SurfaceMesh(const TsdfVolume& volume, double voxel_size,
                         float min_weight);

// Simplifies a surface to at most `max_triangles` (> 0) triangles by merging
// the vertices in cubes of `voxel_size` (m), or larger ones if needed.
TriangleMesh SimplifyMesh(const TriangleMesh& mesh, float voxel_size,
                          size_t max_triangles);

}  // namespace rgbd_pose
