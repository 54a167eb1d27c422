#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace rgbd_pose {

// Writes messages of ROS 2 in CDR, little-endian: a header of four bytes, then
// each number aligned to its size.
class CdrWriter {
 public:
  template <typename T>
  CdrWriter& Number(T value) {
    while (body_.size() % sizeof(T) != 0) body_ += '\0';
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    body_.append(bytes, sizeof(T));
    return *this;
  }
  CdrWriter& Text(const std::string& text) {
    Number(static_cast<uint32_t>(text.size() + 1));
    body_ += text;
    body_ += '\0';
    return *this;
  }
  CdrWriter& Bytes(const std::string& bytes) {
    Number(static_cast<uint32_t>(bytes.size()));
    body_ += bytes;
    return *this;
  }
  // An array of a fixed length.
  CdrWriter& Numbers(const std::vector<double>& numbers) {
    for (const double number : numbers) Number(number);
    return *this;
  }
  // std_msgs/Header; s.
  CdrWriter& Header(double stamp, const std::string& frame) {
    constexpr int64_t kSecond = 1000000000;  // ns
    const int64_t time = std::llround(stamp * kSecond);
    Number(static_cast<int32_t>(time / kSecond));
    Number(static_cast<uint32_t>(time % kSecond));
    return Text(frame);
  }

  std::string message() const {
    return std::string("\x00\x01\x00\x00", 4) + body_;
  }

 private:
  std::string body_;
};

}  // namespace rgbd_pose
