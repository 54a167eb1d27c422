// W3C, Portable Network Graphics (PNG) Specification, second edition, 2003.

#include "frontend/files/png_chunks.h"

#include <libdeflate.h>

#include <cstdint>

namespace rgbd_pose {
namespace {

// Far beyond any depth camera: a few wrong bytes must not claim all memory.
constexpr uint32_t kMaxSide = 1 << 14;

uint32_t BigEndian(const uint8_t* bytes) {
  return static_cast<uint32_t>(bytes[0]) << 24 | bytes[1] << 16 |
         bytes[2] << 8 | bytes[3];
}

struct Chunk {
  std::string_view type;
  std::string_view data;
  bool is_intact = false;  // the checksum is right
};

bool SkipSignature(std::string_view* bytes) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1A\n";
  if (bytes->substr(0, kSignature.size()) != kSignature) return false;
  bytes->remove_prefix(kSignature.size());
  return true;
}

// Takes the next chunk off `bytes`. False if not all of it is there.
bool NextChunk(std::string_view* bytes, Chunk* chunk) {
  constexpr size_t kAround = 12;  // length, type and checksum
  if (bytes->size() < kAround) return false;
  const auto* start = reinterpret_cast<const uint8_t*>(bytes->data());
  const size_t size = BigEndian(start);
  if (size > bytes->size() - kAround) return false;
  chunk->type = bytes->substr(4, 4);
  chunk->data = bytes->substr(8, size);
  chunk->is_intact =
      libdeflate_crc32(0, start + 4, 4 + size) == BigEndian(start + 8 + size);
  bytes->remove_prefix(kAround + size);
  return true;
}

bool ReadHeader(std::string_view header, PngImage* png) {
  if (header.size() != 13) return false;
  const auto* data = reinterpret_cast<const uint8_t*>(header.data());
  const uint32_t width = BigEndian(data);
  const uint32_t height = BigEndian(data + 4);
  if (width < 1 || width > kMaxSide || height < 1 || height > kMaxSide) {
    return false;
  }
  png->width = static_cast<int>(width);
  png->height = static_cast<int>(height);
  png->bit_depth = data[8];
  png->color_type = data[9];
  png->is_interlaced = data[12] == 1;
  // There are five kinds of colour, one of compression, one of filtering, two
  // of interlacing.
  const bool is_color =
      std::string_view("\0\2\3\4\6", 5).find(static_cast<char>(data[9])) !=
      std::string_view::npos;
  return is_color && data[10] == 0 && data[11] == 0 && data[12] <= 1;
}

// Whether it is a kind that is decoded here, as far as the header says.
bool IsOurs(const PngImage& png, PngUse use) {
  if (png.is_interlaced) return false;
  if (use == PngUse::kDepth) {
    return png.bit_depth == 16 && png.color_type == kPngGray;
  }
  return use != PngUse::kOther && png.bit_depth == 8 &&
         (png.color_type == kPngRgb || png.color_type == kPngGray);
}

// Chunks without which nothing can be shown are marked by a capital letter.
bool IsCritical(const Chunk& chunk) { return (chunk.type[0] & 0x20) == 0; }

// Others that leave the values of the pixels alone, unlike a colour space.
bool IsComment(const Chunk& chunk) {
  return chunk.type == "pHYs" || chunk.type == "tIME" || chunk.type == "tEXt";
}

}  // namespace

PngContent ReadPngChunks(std::string_view bytes, PngUse use, PngImage* png) {
  if (!SkipSignature(&bytes)) return PngContent::kNoPng;
  Chunk chunk;
  if (!NextChunk(&bytes, &chunk) || chunk.type != "IHDR" || !chunk.is_intact ||
      !ReadHeader(chunk.data, png)) {
    return PngContent::kDamaged;
  }
  bool is_ours = IsOurs(*png, use);
  if (is_ours) png->compressed.reserve(bytes.size());
  while (NextChunk(&bytes, &chunk)) {
    if (IsCritical(chunk) && !chunk.is_intact) return PngContent::kDamaged;
    if (chunk.type == "IEND") {
      return is_ours ? PngContent::kOurs : PngContent::kOther;
    }
    if (chunk.type != "IDAT") {
      is_ours &= IsComment(chunk) && chunk.is_intact;
    } else if (is_ours) {
      png->compressed += chunk.data;
    }
  }
  return PngContent::kDamaged;
}

}  // namespace rgbd_pose
