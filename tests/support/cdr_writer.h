#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace rgbd_pose {

// Messages of ROS 2 in CDR, little-endian: a header of four bytes, then each
// number aligned to its size.
class CdrWriter {
 public:
  template <typename T>
  CdrWriter& Number(T value) {
    while (body_.size() % sizeof(T) != 0) body_ += '\xee';  // padding
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
  CdrWriter& Numbers(const std::vector<double>& numbers) {
    for (const double number : numbers) Number(number);
    return *this;
  }
  CdrWriter& Header(double stamp, const std::string& frame) {
    const auto seconds = static_cast<int32_t>(stamp);
    Number(seconds);
    Number(static_cast<uint32_t>((stamp - seconds) * 1e9 + 0.5));
    return Text(frame);
  }

  std::string message() const {
    return std::string("\x00\x01\x00\x00", 4) + body_;
  }

 private:
  std::string body_;
};

}  // namespace rgbd_pose
