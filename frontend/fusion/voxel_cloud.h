#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "frontend/fusion/mesh_file.h"

namespace rgbd_pose {

// Merges points in cubes of one size. Only the mean position and colour of each
// non-empty cube are stored. The same points in the same order give the same
// result.
class VoxelCloud {
 public:
  // The side of a cube in metres; must be > 0.
  explicit VoxelCloud(float voxel_size);

  // Ignores points farther than 2^20 cubes from the origin or not finite.
  void Add(const ColoredPoint& point);

  // The number of non-empty cubes.
  int size() const { return static_cast<int>(voxels_.size()); }

  // One point per cube, in the order of the first points in the cubes.
  std::vector<ColoredPoint> Points() const;

  // The cloud with larger cubes: at most `max_points` points, spread evenly.
  // `max_points` must be at least 8, as 8 cubes of any size meet at the origin.
  std::vector<ColoredPoint> Thin(int max_points) const;

 private:
  struct Voxel {
    uint64_t key;
    // These are sums. Positions are relative to the centre of the cube.
    Eigen::Vector3f offset = Eigen::Vector3f::Zero();
    std::array<uint32_t, 3> color = {};
    uint32_t count = 0;
  };

  static constexpr int kSideBits = 2;  // of a block: 4 cubes
  static constexpr int kBlockSize = 1 << 3 * kSideBits;
  // Further points of a cube are not added: the sums would lose accuracy.
  static constexpr uint32_t kMaxCount = 1U << 20;

  Eigen::Vector3f Center(uint64_t key) const;
  Voxel* FindOrInsert(const Eigen::Vector3i& cell);

  float voxel_size_;
  float voxels_per_metre_;
  std::vector<Voxel> voxels_;
  // By the key of a block, for each of its cubes: 1 + index into voxels_, 0 if
  // it is empty. Blocks keep near together what is looked up in turn.
  std::unordered_map<uint64_t, std::array<uint32_t, kBlockSize>> blocks_;
  size_t last_ = 0;  // the last voxel, often shared by the next pixel
};

}  // namespace rgbd_pose
