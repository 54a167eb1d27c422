#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace rgbd_pose {

// Appends a number's bytes, the lowest first, whatever the machine's order.
inline void AppendLittleEndian(uint32_t bits, std::string* bytes) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes->push_back(static_cast<char>(bits >> shift & 0xFF));
  }
}

inline void AppendLittleEndian(uint16_t bits, std::string* bytes) {
  bytes->push_back(static_cast<char>(bits & 0xFF));
  bytes->push_back(static_cast<char>(bits >> 8));
}

inline void AppendLittleEndian(uint64_t bits, std::string* bytes) {
  AppendLittleEndian(static_cast<uint32_t>(bits), bytes);
  AppendLittleEndian(static_cast<uint32_t>(bits >> 32), bytes);
}

inline void AppendLittleEndian(double value, std::string* bytes) {
  uint64_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  AppendLittleEndian(bits, bytes);
}

inline void AppendLittleEndian(float value, std::string* bytes) {
  uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  AppendLittleEndian(bits, bytes);
}

}  // namespace rgbd_pose
