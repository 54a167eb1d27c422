#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace rgbd_pose {

// Appends the bytes of a number in little-endian order on any machine.
template <typename T>
void AppendLittleEndian(T value, std::string* bytes) {
  static_assert(sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8);
  using Half = std::conditional_t<sizeof(T) == 2, uint16_t, uint32_t>;
  std::conditional_t<sizeof(T) == 8, uint64_t, Half> bits;
  std::memcpy(&bits, &value, sizeof(bits));
  for (size_t i = 0; i < sizeof(bits); ++i) {
    bytes->push_back(static_cast<char>(bits >> 8 * i & 0xFF));
  }
}

}  // namespace rgbd_pose
