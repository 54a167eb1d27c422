// W3C, Portable Network Graphics (PNG) Specification, second edition, 2003.

#include "frontend/files/png_decoder.h"

#include <libdeflate.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "frontend/files/image_file.h"

namespace rgbd_pose {
namespace {

// The contents of a PNG file.
struct PngImage {
  int width = 0;
  int height = 0;
  bool is_rgb = false;     // three channels, otherwise one
  bool is_ours = false;    // whether it is decoded here for the given use
  std::string compressed;  // if it is decoded here
};

uint32_t BigEndian(const uint8_t* bytes) {
  return static_cast<uint32_t>(bytes[0]) << 24 | bytes[1] << 16 |
         bytes[2] << 8 | bytes[3];
}

struct Chunk {
  std::string_view type;
  std::string_view data;
  bool is_intact = false;  // whether the checksum is correct
};

// Removes the next chunk from `bytes`. False if it is incomplete.
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

// Reads the header (section 11.2.2). False if it is invalid.
bool ReadHeader(std::string_view header, PngUse use, PngImage* png) {
  if (header.size() != 13) return false;
  const auto* data = reinterpret_cast<const uint8_t*>(header.data());
  const uint32_t width = BigEndian(data);
  const uint32_t height = BigEndian(data + 4);
  if (width < 1 || width > kMaxImageSide || height < 1 ||
      height > kMaxImageSide) {
    return false;
  }
  png->width = static_cast<int>(width);
  png->height = static_cast<int>(height);
  const int bits = data[8], color_type = data[9], interlacing = data[12];
  png->is_rgb = color_type == 2;
  const bool is_gray = color_type == 0;
  png->is_ours =
      interlacing == 0 &&
      (use == PngUse::kDepth ? bits == 16 && is_gray
                             : bits == 8 && (is_gray || png->is_rgb));
  // There are five colour types, one method each of compression and filters.
  const bool is_color =
      std::string_view("\0\2\3\4\6", 5).find(static_cast<char>(color_type)) !=
      std::string_view::npos;
  return is_color && data[10] == 0 && data[11] == 0 && interlacing <= 1;
}

// Reads all chunks after the signature. False if the file is damaged.
bool ReadPngChunks(std::string_view bytes, PngUse use, PngImage* png) {
  Chunk chunk;
  if (!NextChunk(&bytes, &chunk) || chunk.type != "IHDR" || !chunk.is_intact ||
      !ReadHeader(chunk.data, use, png)) {
    return false;
  }
  if (png->is_ours) png->compressed.reserve(bytes.size());
  while (NextChunk(&bytes, &chunk)) {
    // Chunks needed to decode the image begin with a capital letter.
    const bool is_critical = (chunk.type[0] & 0x20) == 0;
    if (is_critical && !chunk.is_intact) return false;
    if (chunk.type == "IEND") return true;
    if (chunk.type != "IDAT") {
      // Other chunks may affect pixel values, such as a colour space.
      png->is_ours &=
          chunk.is_intact && (chunk.type == "pHYs" || chunk.type == "tIME" ||
                              chunk.type == "tEXt");
    } else if (png->is_ours) {
      png->compressed += chunk.data;
    }
  }
  return false;
}

// The neighbour nearest to left + up - up_left. Computed without branches, as
// their conditions would depend on noise.
int PaethPredictor(int left, int up, int up_left) {
  const int left_distance = std::abs(up - up_left);
  const int up_distance = std::abs(left - up_left);
  const int up_left_distance = std::abs(left + up - 2 * up_left);
  const int nearer = up_distance <= up_left_distance ? up : up_left;
  const bool is_left =
      (left_distance <= up_distance) & (left_distance <= up_left_distance);
  return is_left ? left : nearer;
}

// Reverses a filter of section 9 by adding its prediction to each byte of a
// row, with all channels in parallel. False if the filter does not exist.
template <int kPixelBytes>
bool Unfilter(int filter, const uint8_t* up_row, uint8_t* row, int size) {
  const auto add = [=](auto predict) {
    int left[kPixelBytes] = {};
    int up_left[kPixelBytes] = {};
    for (int i = 0; i < size; i += kPixelBytes) {
      for (int k = 0; k < kPixelBytes; ++k) {
        const int up = up_row[i + k];
        const int value = row[i + k] + predict(left[k], up, up_left[k]);
        row[i + k] = static_cast<uint8_t>(value);
        left[k] = row[i + k];
        up_left[k] = up;
      }
    }
  };
  if (filter == 1) add([](int left, int, int) { return left; });
  if (filter == 2) add([](int, int up, int) { return up; });
  if (filter == 3) add([](int left, int up, int) { return (left + up) / 2; });
  if (filter == 4) add(PaethPredictor);
  return filter <= 4;
}

// Decompresses `size` bytes. Null if there are fewer or they are damaged.
std::unique_ptr<uint8_t[]> Decompress(const PngImage& png, size_t size,
                                      bool* has_more) {
  // Of the format; no memory is allocated for an impossible size.
  constexpr size_t kMaxRatio = 1032;
  if (size / kMaxRatio > png.compressed.size()) return nullptr;
  std::unique_ptr<uint8_t[]> rows(new uint8_t[size]);
  const std::unique_ptr<libdeflate_decompressor,
                        void (*)(libdeflate_decompressor*)>
      decompressor(libdeflate_alloc_decompressor(),
                   libdeflate_free_decompressor);
  if (decompressor == nullptr) return nullptr;
  const libdeflate_result result = libdeflate_zlib_decompress(
      decompressor.get(), png.compressed.data(), png.compressed.size(),
      rows.get(), size, nullptr);
  *has_more = result == LIBDEFLATE_INSUFFICIENT_SPACE;
  if (result != LIBDEFLATE_SUCCESS && !*has_more) return nullptr;
  return rows;
}

// Reverses the filters of `rows` and calls `convert(row, y)` for each row.
// False if a filter does not exist.
template <int kPixelBytes, typename Convert>
bool ReadRows(const PngImage& png, uint8_t* rows, Convert convert) {
  const int size = kPixelBytes * png.width;
  const std::vector<uint8_t> above_first(size, 0);
  const uint8_t* up_row = above_first.data();
  for (int y = 0; y < png.height; ++y) {
    uint8_t* row = rows + y * (1 + static_cast<size_t>(size)) + 1;
    if (!Unfilter<kPixelBytes>(row[-1], up_row, row, size)) return false;
    convert(row, y);
    up_row = row;
  }
  return true;
}

// Reads gray values and, unless their image is empty, colours.
template <int kChannels>
bool ReadGray(const PngImage& png, uint8_t* rows, DecodedPng* decoded) {
  cv::Mat& color = decoded->color;
  return ReadRows<kChannels>(png, rows, [&](const uint8_t* row, int y) {
    uint8_t* to = decoded->image.ptr<uint8_t>(y);
    uint8_t* bgr = color.empty() ? nullptr : color.ptr<uint8_t>(y);
    for (int x = 0; x < png.width; ++x, row += kChannels) {
      const uint8_t red = row[0];
      const uint8_t green = row[kChannels / 2];
      const uint8_t blue = row[kChannels - 1];
      to[x] = GrayLevel(red, green, blue);
      if (bgr == nullptr) continue;
      *bgr++ = blue;
      *bgr++ = green;
      *bgr++ = red;
    }
  });
}

bool ReadDepth(const PngImage& png, uint8_t* rows, cv::Mat* depth) {
  return ReadRows<2>(png, rows, [&](const uint8_t* row, int y) {
    uint16_t* to = depth->ptr<uint16_t>(y);
    for (int x = 0; x < png.width; ++x) {
      to[x] = static_cast<uint16_t>(row[2 * x] << 8 | row[2 * x + 1]);
    }
  });
}

}  // namespace

DecodedPng DecodePng(std::string_view bytes, PngUse use) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1A\n";
  if (bytes.rfind(kSignature, 0) != 0) return {};
  DecodedPng damaged = {{}, {}, /*is_damaged=*/true};
  bytes.remove_prefix(kSignature.size());
  PngImage png;
  if (!ReadPngChunks(bytes, use, &png)) return damaged;
  if (!png.is_ours) return {};

  const bool is_depth = use == PngUse::kDepth;
  const size_t row_bytes = (png.is_rgb ? 3 : is_depth ? 2 : 1) * png.width;
  bool has_more = false;
  const std::unique_ptr<uint8_t[]> rows =
      Decompress(png, (1 + row_bytes) * png.height, &has_more);
  if (has_more) return {};
  if (rows == nullptr) return damaged;
  DecodedPng decoded;
  decoded.image.create(png.height, png.width, is_depth ? CV_16UC1 : CV_8UC1);
  if (use == PngUse::kGrayAndColor) {
    decoded.color.create(png.height, png.width, CV_8UC3);
  }
  const bool is_read = is_depth     ? ReadDepth(png, rows.get(), &decoded.image)
                       : png.is_rgb ? ReadGray<3>(png, rows.get(), &decoded)
                                    : ReadGray<1>(png, rows.get(), &decoded);
  return is_read ? decoded : damaged;
}

}  // namespace rgbd_pose
