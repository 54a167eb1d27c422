#include "frontend/fusion/voxel_cloud.h"

#include <cmath>
#include <opencv2/core/fast_math.hpp>

#include "frontend/fusion/voxel_key.h"

namespace rgbd_pose {

VoxelCloud::VoxelCloud(float voxel_size)
    : voxel_size_(voxel_size), voxels_per_metre_(1.0F / voxel_size) {}

void VoxelCloud::Add(const ColoredPoint& point) {
  Eigen::Vector3i cell;
  for (int i = 0; i < 3; ++i) {
    const float x = point.position[i] * voxels_per_metre_;
    // The negated condition also rejects NaN.
    if (!(x >= -kVoxelKeyRange && x < kVoxelKeyRange)) return;
    cell[i] = cvFloor(x);
  }
  Voxel* voxel = FindOrInsert(cell);
  if (voxel->count == kMaxCount) return;
  voxel->offset += point.position - Center(voxel->key);
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

VoxelCloud::Voxel* VoxelCloud::FindOrInsert(const Eigen::Vector3i& cell) {
  const uint64_t key = VoxelKey(cell);
  if (last_ < voxels_.size() && voxels_[last_].key == key) {
    return &voxels_[last_];
  }
  Eigen::Vector3i block;
  int in_block = 0;
  for (int i = 0; i < 3; ++i) {
    block[i] = cell[i] >> kSideBits;  // rounds down
    in_block = in_block << kSideBits | (cell[i] & ((1 << kSideBits) - 1));
  }
  uint32_t& place = blocks_[VoxelKey(block)][in_block];
  if (place == 0) {
    voxels_.push_back({key});
    place = static_cast<uint32_t>(voxels_.size());
  }
  last_ = place - 1;
  return &voxels_[last_];
}

}  // namespace rgbd_pose
