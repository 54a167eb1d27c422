#pragma once

#include <algorithm>
#include <cstring>
#include <iterator>
#include <string>

namespace rgbd_pose {

// Appends the bytes of a number in little-endian order on any machine.
template <typename T>
void AppendLittleEndian(T value, std::string* bytes) {
  char own[sizeof(T)];
  std::memcpy(own, &value, sizeof(T));
  if (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) {
    std::reverse(std::begin(own), std::end(own));
  }
  bytes->append(own, sizeof(T));
}

}  // namespace rgbd_pose
