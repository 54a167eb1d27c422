#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/util/format.h"

namespace rgbd_pose {

// A 64-bit hash of texts or bytes, the same on every platform: FNV-1a (Fowler,
// Noll & Vo). It detects accidental, not malicious, differences.
class TextHash {
 public:
  // Adds a text and its length: "a", "bc" differ from "ab", "c".
  TextHash& Add(std::string_view text) {
    uint64_t state = state_;
    for (const char c : text) state = AddByte(state, static_cast<uint8_t>(c));
    for (uint64_t size = text.size(), i = 0; i < 8; ++i, size >>= 8) {
      state = AddByte(state, size & 0xff);
    }
    state_ = state;
    return *this;
  }

  // 16 hexadecimal digits.
  std::string Hex() const {
    return Format("%016llx", static_cast<unsigned long long>(state_));
  }

 private:
  static uint64_t AddByte(uint64_t state, uint64_t byte) {
    return (state ^ byte) * 0x100000001b3u;
  }

  uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace rgbd_pose
