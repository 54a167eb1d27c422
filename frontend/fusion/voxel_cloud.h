#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "frontend/fusion/triangle_mesh.h"

namespace rgbd_pose {

// Points merged in cubes of one size: what is kept is the mean position and
// colour of each cube that holds any, so memory grows with the surface seen and
// not with the number of points. The same points in the same order give the
// same cloud.
class VoxelCloud {
 public:
  // The side of a cube in metres; must be > 0.
  explicit VoxelCloud(float voxel_size);

  // Points further than 2^20 cubes from the origin, or not finite, are left
  // out.
  void Add(const ColoredPoint& point);

  // The number of cubes that hold a point.
  int size() const { return static_cast<int>(voxels_.size()); }
  bool empty() const { return voxels_.empty(); }

  // What Add takes, in bytes.
  size_t MemoryBytes() const;

  // One point a cube, in the order in which they were first met.
  std::vector<ColoredPoint> Points() const;

  // The same surfaces in at most `max_points` points, spread evenly: the cloud
  // with larger cubes. At least 8: so many meet at the origin, of any size.
  std::vector<ColoredPoint> Thin(int max_points) const;

 private:
  struct Voxel {
    uint64_t key;
    // Sums; positions from the cube's centre, where floats are exact enough
    // for any number of points.
    float offset[3];
    uint32_t color[3];
    uint32_t count;
  };

  Eigen::Vector3f Center(uint64_t key) const;
  Voxel* FindOrInsert(uint64_t key);
  size_t FirstSlot(uint64_t key) const;
  void Grow();

  float voxel_size_;
  float voxels_per_metre_;
  std::vector<Voxel> voxels_;
  // Open addressing: 1 + index into voxels_, 0 for none; a power of two long.
  std::vector<uint32_t> slots_;
  int hash_shift_;
  size_t last_ = 0;  // the voxel met last: neighbouring pixels share it
};

}  // namespace rgbd_pose
