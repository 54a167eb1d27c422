#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rgbd_pose {

// A 64-bit hash of texts or bytes, the same on every platform: FNV-1a (Fowler,
// Noll & Vo). It distinguishes what differs by accident, not by malice; one
// changed byte always changes it.
class TextHash {
 public:
  // Adds a text and that it ends here: "a" and "bc" are not "ab" and "c".
  void Add(std::string_view text);

  // 16 hexadecimal digits.
  std::string Hex() const;

 private:
  uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace rgbd_pose
