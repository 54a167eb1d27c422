#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace rgbd_pose {

// A grid cell, up to 2^20 cells from the origin, as one number that can be
// compared, sorted and hashed: 21 bits per coordinate, x in the highest bits.
constexpr int kVoxelKeyBits = 21;
constexpr int kVoxelKeyRange = 1 << (kVoxelKeyBits - 1);
constexpr uint64_t kVoxelKeyMask = (uint64_t{1} << kVoxelKeyBits) - 1;

inline uint64_t VoxelKey(const Eigen::Vector3i& cell) {
  uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    key = key << kVoxelKeyBits |
          (static_cast<uint64_t>(cell[i] + kVoxelKeyRange) & kVoxelKeyMask);
  }
  return key;
}

inline Eigen::Vector3i VoxelOfKey(uint64_t key) {
  Eigen::Vector3i cell;
  for (int i = 2; i >= 0; --i, key >>= kVoxelKeyBits) {
    cell[i] = static_cast<int>(key & kVoxelKeyMask) - kVoxelKeyRange;
  }
  return cell;
}

}  // namespace rgbd_pose
