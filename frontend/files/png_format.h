#pragma once

#include <cstdint>
#include <cstdlib>
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

// W3C, Portable Network Graphics (PNG) Specification, second edition, 2003,
// section 9.

// The neighbour nearest to left + up - up_left. Chosen without branches: what
// they would depend on is noise.
inline int PaethPredictor(int left, int up, int up_left) {
  const int left_distance = std::abs(up - up_left);
  const int up_distance = std::abs(left - up_left);
  const int up_left_distance = std::abs(left + up - 2 * up_left);
  const int nearer = up_distance <= up_left_distance ? up : up_left;
  const bool is_left =
      (left_distance <= up_distance) & (left_distance <= up_left_distance);
  return is_left ? left : nearer;
}

// Adds to each byte of a row what its neighbours predict, all channels abreast.
template <int kPixelBytes, typename Predict>
void AddPrediction(const uint8_t* up_row, uint8_t* row, int size,
                   Predict predict) {
  int left[kPixelBytes] = {};
  int up_left[kPixelBytes] = {};
  for (int i = 0; i < size; i += kPixelBytes) {
    for (int k = 0; k < kPixelBytes; ++k) {
      const int up = up_row[i + k];
      const int value = row[i + k] + predict(left[k], up, up_left[k]);
      row[i + k] = static_cast<uint8_t>(value);
      left[k] = row[i + k];
      up_left[k] = up;
    }
  }
}

// Undoes a filter of section 9. False for one that does not exist.
template <int kPixelBytes>
bool Unfilter(int filter, const uint8_t* up_row, uint8_t* row, int size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      AddPrediction<kPixelBytes>(up_row, row, size,
                                 [](int left, int, int) { return left; });
      return true;
    case 2:
      AddPrediction<kPixelBytes>(up_row, row, size,
                                 [](int, int up, int) { return up; });
      return true;
    case 3:
      AddPrediction<kPixelBytes>(up_row, row, size, [](int left, int up, int) {
        return (left + up) / 2;
      });
      return true;
    case 4:
      AddPrediction<kPixelBytes>(up_row, row, size, PaethPredictor);
      return true;
    default:
      return false;
  }
}

}  // namespace rgbd_pose
