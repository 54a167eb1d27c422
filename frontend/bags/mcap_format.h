#pragma once

#include <cstdint>
#include <string_view>

namespace rgbd_pose {

// The first and the last bytes of an mcap file (mcap.dev/spec).
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

// The kinds of records.
enum McapOpcode : uint8_t {
  kMcapHeader = 0x01,
  kMcapFooter = 0x02,
  kMcapSchema = 0x03,
  kMcapChannel = 0x04,
  kMcapMessage = 0x05,
  kMcapChunk = 0x06,
  kMcapMessageIndex = 0x07,
  kMcapChunkIndex = 0x08,
  kMcapStatistics = 0x0b,
  kMcapDataEnd = 0x0f,
};

// The CRC-32 of the bytes, after others with the CRC-32 `before`. In a build
// without libdeflate 0, which in a file means that there is none.
uint32_t McapChecksum(std::string_view bytes, uint32_t before = 0);

}  // namespace rgbd_pose
