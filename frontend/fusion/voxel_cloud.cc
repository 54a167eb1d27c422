#include "frontend/fusion/voxel_cloud.h"

#include <cmath>
#include <opencv2/core/fast_math.hpp>

#include "frontend/fusion/voxel_key.h"

namespace rgbd_pose {

VoxelCloud::VoxelCloud(float voxel_size)
    : voxel_size_(voxel_size),
      voxels_per_metre_(1.0F / voxel_size),
      slots_(size_t{1} << kFirstSlotBits, 0),
      hash_shift_(64 - kFirstSlotBits) {}

void VoxelCloud::Add(const ColoredPoint& point) {
  Eigen::Vector3i cell;
  for (int i = 0; i < 3; ++i) {
    const float x = point.position[i] * voxels_per_metre_;
    // The negated condition also rejects NaN.
    if (!(x >= -kVoxelKeyRange && x < kVoxelKeyRange)) return;
    cell[i] = cvFloor(x);
  }
  const uint64_t key = VoxelKey(cell);
  Voxel* voxel = FindOrInsert(key);
  if (voxel->count == kMaxCount) return;
  voxel->offset += point.position - Center(key);
  for (int i = 0; i < 3; ++i) voxel->color[i] += point.color[i];
  ++voxel->count;
}

std::vector<ColoredPoint> VoxelCloud::Points() const {
  std::vector<ColoredPoint> points;
  points.reserve(voxels_.size());
  for (const Voxel& voxel : voxels_) {
    const uint32_t count = voxel.count;
    ColoredPoint& point = points.emplace_back();
    point.position =
        Center(voxel.key) + voxel.offset / static_cast<float>(count);
    for (int i = 0; i < 3; ++i) {
      point.color[i] =
          static_cast<uint8_t>((voxel.color[i] + count / 2) / count);
    }
  }
  return points;
}

std::vector<ColoredPoint> VoxelCloud::Thin(int max_points) const {
  std::vector<ColoredPoint> points = Points();
  float size = voxel_size_;
  while (points.size() > static_cast<size_t>(max_points)) {
    // As points are on surfaces, the number of cubes falls with the square of
    // their side. kMore makes the loop end even if this is not exactly true.
    constexpr float kMore = 1.02F;
    size *= kMore * std::sqrt(static_cast<float>(points.size()) /
                              static_cast<float>(max_points));
    VoxelCloud coarser(size);
    for (const ColoredPoint& point : points) coarser.Add(point);
    points = coarser.Points();
  }
  return points;
}

Eigen::Vector3f VoxelCloud::Center(uint64_t key) const {
  return (VoxelOfKey(key).cast<float>().array() + 0.5F) * voxel_size_;
}

VoxelCloud::Voxel* VoxelCloud::FindOrInsert(uint64_t key) {
  if (last_ < voxels_.size() && voxels_[last_].key == key) {
    return &voxels_[last_];
  }
  uint32_t* slot = &slots_[SlotOf(key)];
  if (*slot == 0) {
    voxels_.push_back({key});
    *slot = static_cast<uint32_t>(voxels_.size());
  }
  last_ = *slot - 1;
  // The table is at most half full, so that a search takes 1.5 probes on
  // average.
  if (2 * voxels_.size() > slots_.size()) {
    slots_.assign(2 * slots_.size(), 0);
    --hash_shift_;
    for (size_t i = 0; i < voxels_.size(); ++i) {
      slots_[SlotOf(voxels_[i].key)] = static_cast<uint32_t>(i + 1);
    }
  }
  return &voxels_[last_];
}

size_t VoxelCloud::SlotOf(uint64_t key) const {
  // Knuth's multiplicative hashing: 2^64 over the golden ratio. It hashes
  // blocks of 2 x 2 x 4 cubes, whose slots share a cache line, because most
  // lookups are next to the previous one.
  constexpr uint64_t kInBlock =
      (1ULL << 2 * kVoxelKeyBits) | (1ULL << kVoxelKeyBits) | 3;
  const uint64_t in_block = (key >> (2 * kVoxelKeyBits) & 1) << 3 |
                            (key >> kVoxelKeyBits & 1) << 2 | (key & 3);
  const uint64_t hash = (key & ~kInBlock) * 0x9E3779B97F4A7C15ULL;
  size_t slot = ((hash >> hash_shift_) & ~uint64_t{15}) | in_block;
  while (slots_[slot] != 0 && voxels_[slots_[slot] - 1].key != key) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

}  // namespace rgbd_pose
