#pragma once

#include <algorithm>
#include <cstring>
#include <iterator>
#include <string>

namespace rgbd_pose {

// Returns the text that printf would print, independent of the locale.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

// Rounded to two significant digits of its standard deviation.
std::string NumberTo(double value, double sigma);

// The fewest digits that identify the number: 0.2, not 0.2000...01.
std::string ShortNumber(double value);

// The Base64 encoding of the bytes (RFC 4648).
std::string Base64(const std::string& bytes);

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
