#include "core/util/text_hash.h"

#include <cstdio>

namespace rgbd_pose {
namespace {

uint64_t AddByte(uint64_t state, uint64_t byte) {
  return (state ^ byte) * 0x100000001b3u;
}

}  // namespace

void TextHash::Add(std::string_view text) {
  uint64_t state = state_;
  for (const char c : text) state = AddByte(state, static_cast<uint8_t>(c));
  for (uint64_t size = text.size(), i = 0; i < 8; ++i, size >>= 8) {
    state = AddByte(state, size & 0xff);
  }
  state_ = state;
}

std::string TextHash::Hex() const {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx",
                static_cast<unsigned long long>(state_));
  return text;
}

}  // namespace rgbd_pose
