#pragma once

#include <cstdint>

namespace rgbd_pose {

// The grey level of a colour, 0.299 R + 0.587 G + 0.114 B rounded, as OpenCV's
// cvtColor has it: the same wherever an image comes from.
inline uint8_t GrayLevel(int red, int green, int blue) {
  // In 15 bits; they add up to 1.
  return static_cast<uint8_t>(
      (9798 * red + 19235 * green + 3735 * blue + (1 << 14)) >> 15);
}

}  // namespace rgbd_pose
