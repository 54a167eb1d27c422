#pragma once

#include <libdeflate.h>

#include <cstdint>
#include <memory>
#include <string>

namespace rgbd_pose {

inline std::string BigEndian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes += static_cast<char>(value >> shift & 0xFF);
  }
  return bytes;
}

inline std::string Chunk(const std::string& type, const std::string& data) {
  const std::string checked = type + data;
  return BigEndian(static_cast<uint32_t>(data.size())) + checked +
         BigEndian(libdeflate_crc32(0, checked.data(), checked.size()));
}

inline std::string Compress(const std::string& data) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)>
      compressor(libdeflate_alloc_compressor(6), libdeflate_free_compressor);
  std::string packed(
      libdeflate_zlib_compress_bound(compressor.get(), data.size()), '\0');
  packed.resize(libdeflate_zlib_compress(compressor.get(), data.data(),
                                         data.size(), packed.data(),
                                         packed.size()));
  return packed;
}

// The parts of a PNG file, which can be damaged one by one.
struct PngParts {
  uint32_t width = 0;
  uint32_t height = 0;
  std::string kind;          // bit depth, colour type, three methods
  std::string before_image;  // further chunks
  std::string rows;          // uncompressed

  std::string Header() const {
    return Chunk("IHDR", BigEndian(width) + BigEndian(height) + kind);
  }

  std::string File() const {
    const std::string packed = Compress(rows);
    const size_t half = packed.size() / 2;
    return "\x89PNG\r\n\x1A\n" + Header() + before_image +
           Chunk("IDAT", packed.substr(0, half)) +
           Chunk("IDAT", packed.substr(half)) + Chunk("IEND", "");
  }
};

}  // namespace rgbd_pose
