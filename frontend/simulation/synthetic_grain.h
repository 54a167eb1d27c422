#pragma once

#include <cstdint>

namespace rgbd_pose {

// The grain of a surface at (u, v) (m), seen by a pixel of extent `footprint`
// (m): a sum of octaves of value noise in about -3..3. The same bits with every
// instruction set.
float Grain(float u, float v, float footprint, uint32_t seed);

}  // namespace rgbd_pose
