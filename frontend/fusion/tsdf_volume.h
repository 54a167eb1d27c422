#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace rgbd_pose {

// What is known at a corner of the voxels.
struct DistanceVoxel {
  float distance = 0.0F;               // to the surface, m; > 0 before it
  float weight = 0.0F;                 // 1 / m^2; 0: nothing is known
  std::array<uint16_t, 3> color = {};  // red, green, blue, in 1/256
};

// Distances to a surface on a grid, kept in blocks where there are any: memory
// grows with the surface. Grid points are whole numbers of voxels from the
// origin, up to 2^20 blocks away.
class TsdfVolume {
 public:
  // Of a block; z counts fastest, then y, then x.
  static constexpr int kSide = 8;
  static constexpr int kBlockSize = kSide * kSide * kSide;
  using Block = std::array<DistanceVoxel, kBlockSize>;
  static int PlaceOf(int x, int y, int z) {
    return (x * kSide + y) * kSide + z;
  }

  // The block of a key (voxel_key.h), made if it is not there. Stays where it
  // is.
  Block* FindOrInsert(uint64_t key) {
    const auto [place, is_new] = index_.emplace(key, size());
    if (is_new) {
      keys_.push_back(key);
      blocks_.push_back(std::make_unique<Block>());
    }
    return blocks_[place->second].get();
  }

  // The number of blocks, and each in the order in which they were made.
  int size() const { return static_cast<int>(blocks_.size()); }
  uint64_t key(int index) const { return keys_[index]; }
  const Block& block(int index) const { return *blocks_[index]; }

  // Which one it is; -1: not there.
  int Find(uint64_t key) const {
    const auto place = index_.find(key);
    return place == index_.end() ? -1 : place->second;
  }

  // What the blocks take, in bytes.
  size_t MemoryBytes() const { return blocks_.size() * sizeof(Block); }

 private:
  std::vector<uint64_t> keys_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::unordered_map<uint64_t, int> index_;  // for looking up alone
};

}  // namespace rgbd_pose
