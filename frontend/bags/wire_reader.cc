#include "frontend/bags/wire_reader.h"

#include <algorithm>
#include <cstring>

namespace rgbd_pose {

WireReader::WireReader(std::string_view message, WireFormat format)
    : rest_(message), format_(format) {
  constexpr bool kHostIsBigEndian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  if (format == WireFormat::kRos1) {
    swaps_ = kHostIsBigEndian;
    return;
  }
  // The first two bytes give the kind of CDR: 0 0 is big-endian, 0 1 is
  // little-endian. The next two bytes are unused.
  const std::string_view kind = Take(4);
  if (kind[0] != 0 || (kind[1] != 0 && kind[1] != 1)) {
    throw InputError("a message has an unknown encoding (CDR kind " +
                     std::to_string(static_cast<uint8_t>(kind[1])) + ")");
  }
  swaps_ = (kind[1] == 0) != kHostIsBigEndian;
  place_ = 0;
}

std::string_view WireReader::Take(size_t size) {
  if (size > rest_.size()) {
    throw Damaged("a message ends too early: " + std::to_string(size) +
                  " bytes expected, " + std::to_string(rest_.size()) + " left");
  }
  const std::string_view taken = rest_.substr(0, size);
  rest_.remove_prefix(size);
  place_ += size;
  return taken;
}

void WireReader::ReadNumber(void* value, size_t size) {
  if (format_ == WireFormat::kCdr) Take((size - place_ % size) % size);
  const std::string_view bytes = Take(size);
  char* to = static_cast<char*>(value);
  std::memcpy(to, bytes.data(), size);
  if (swaps_) std::reverse(to, to + size);
}

std::string_view WireReader::Text() {
  std::string_view text = Bytes();
  // The length in CDR includes the terminating 0.
  if (format_ == WireFormat::kCdr && !text.empty()) text.remove_suffix(1);
  return text;
}

std::string_view WireReader::Bytes() { return Take(Number<uint32_t>()); }

uint32_t WireReader::Count(size_t least_bytes) {
  const uint32_t count = Number<uint32_t>();
  if (count > rest_.size() / least_bytes) {
    throw Damaged("a message ends too early: a list of " +
                  std::to_string(count) + " elements exceeds the rest");
  }
  return count;
}

}  // namespace rgbd_pose
