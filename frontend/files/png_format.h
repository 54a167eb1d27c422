#pragma once

#include <cstdint>
#include <string>

namespace rgbd_pose {

// Four bytes, the highest first, as numbers stand in a PNG file.
inline std::string PngNumber(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<char>(value >> shift & 0xFF));
  }
  return bytes;
}

// How a PNG file of one channel begins, up to the checksum of its header: of so
// many pixels with so many bits, not interlaced (PNG Specification, sections
// 5.2 and 11.2.2).
inline std::string PngStart(int width, int height, int bits) {
  constexpr uint32_t kHeaderSize = 13;
  return "\x89PNG\r\n\x1A\n" + PngNumber(kHeaderSize) + "IHDR" +
         PngNumber(width) + PngNumber(height) + static_cast<char>(bits) +
         std::string(4, '\0');
}

}  // namespace rgbd_pose
