// W3C, Portable Network Graphics (PNG) Specification, second edition, 2003.

#include <libdeflate.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "frontend/files/image_file.h"
#include "frontend/files/png_codec.h"

namespace rgbd_pose {
namespace {

// Colour types (section 11.2.2).
constexpr int kPngGray = 0;
constexpr int kPngRgb = 2;

// The contents of the chunks of a PNG file.
struct PngImage {
  int width = 0;
  int height = 0;
  int bit_depth = 0;
  int color_type = 0;
  bool is_interlaced = false;
  std::string compressed;

  // Bytes per row, with the filter type before the pixels.
  size_t Stride(int pixel_bytes) const {
    return 1 + static_cast<size_t>(pixel_bytes) * width;
  }
};

// What a file contains according to its chunks.
enum class PngContent {
  kDamaged,
  kOther,  // no PNG or one that is not decoded here for the given use
  kOurs,
};

// More than any camera has; keeps a few wrong bytes from allocating all memory.
constexpr uint32_t kMaxSide = 1 << 14;

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
  // There are five colour types, one compression method, one filter method and
  // two interlace methods.
  const bool is_color =
      std::string_view("\0\2\3\4\6", 5).find(static_cast<char>(data[9])) !=
      std::string_view::npos;
  return is_color && data[10] == 0 && data[11] == 0 && data[12] <= 1;
}

// Whether by its header an image is of a kind that is decoded here.
bool IsOurs(const PngImage& png, PngUse use) {
  if (png.is_interlaced) return false;
  if (use == PngUse::kDepth) {
    return png.bit_depth == 16 && png.color_type == kPngGray;
  }
  return use != PngUse::kOther && png.bit_depth == 8 &&
         (png.color_type == kPngRgb || png.color_type == kPngGray);
}

// Reads all chunks. If the result is kOurs, `png` has the compressed bytes.
PngContent ReadPngChunks(std::string_view bytes, PngUse use, PngImage* png) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1A\n";
  if (bytes.rfind(kSignature, 0) != 0) return PngContent::kOther;
  bytes.remove_prefix(kSignature.size());
  Chunk chunk;
  if (!NextChunk(&bytes, &chunk) || chunk.type != "IHDR" || !chunk.is_intact ||
      !ReadHeader(chunk.data, png)) {
    return PngContent::kDamaged;
  }
  bool is_ours = IsOurs(*png, use);
  if (is_ours) png->compressed.reserve(bytes.size());
  while (NextChunk(&bytes, &chunk)) {
    // Chunks needed to decode the image begin with a capital letter.
    const bool is_critical = (chunk.type[0] & 0x20) == 0;
    if (is_critical && !chunk.is_intact) return PngContent::kDamaged;
    if (chunk.type == "IEND") {
      return is_ours ? PngContent::kOurs : PngContent::kOther;
    }
    if (chunk.type != "IDAT") {
      // Other chunks may affect pixel values, such as a colour space.
      is_ours &=
          chunk.is_intact && (chunk.type == "pHYs" || chunk.type == "tIME" ||
                              chunk.type == "tEXt");
    } else if (is_ours) {
      png->compressed += chunk.data;
    }
  }
  return PngContent::kDamaged;
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

// Adds its prediction to each byte of a row, with all channels in parallel.
template <int kPixelBytes, typename Predict>
void AddPrediction(const uint8_t* up_row, uint8_t* row, int size,
                   Predict predict) {
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
}

// Reverses a filter of section 9. False if the filter does not exist.
template <int kPixelBytes>
bool Unfilter(int filter, const uint8_t* up_row, uint8_t* row, int size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      AddPrediction<kPixelBytes>(up_row, row, size,
                                 [](int left, int, int) { return left; });
      return true;
    case 2:
      AddPrediction<kPixelBytes>(up_row, row, size,
                                 [](int, int up, int) { return up; });
      return true;
    case 3:
      AddPrediction<kPixelBytes>(up_row, row, size, [](int left, int up, int) {
        return (left + up) / 2;
      });
      return true;
    case 4:
      AddPrediction<kPixelBytes>(up_row, row, size, PaethPredictor);
      return true;
    default:
      return false;
  }
}

// Decompresses an image of `size` bytes. Null if there are fewer or they are
// damaged. `has_more`: whether there are more.
std::unique_ptr<uint8_t[]> Decompress(const PngImage& png, size_t size,
                                      bool* has_more) {
  // Maximum compression ratio of the format. The check avoids allocating memory
  // for an impossible size.
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
    uint8_t* row = rows + y * png.Stride(kPixelBytes) + 1;
    if (!Unfilter<kPixelBytes>(row[-1], up_row, row, size)) return false;
    convert(row, y);
    up_row = row;
  }
  return true;
}

// Reads gray values and, unless `color` is empty, colours.
template <int kChannels>
bool ReadGray(const PngImage& png, uint8_t* rows, cv::Mat* gray,
              cv::Mat* color) {
  return ReadRows<kChannels>(png, rows, [&](const uint8_t* row, int y) {
    uint8_t* to = gray->ptr<uint8_t>(y);
    uint8_t* bgr = color->empty() ? nullptr : color->ptr<uint8_t>(y);
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
  DecodedPng decoded;
  PngImage png;
  const PngContent content = ReadPngChunks(bytes, use, &png);
  decoded.is_damaged = content == PngContent::kDamaged;
  if (content != PngContent::kOurs) return decoded;

  const bool is_rgb = png.color_type == kPngRgb;
  const int pixel_bytes = is_rgb ? 3 : png.bit_depth / 8;
  bool has_more = false;
  const std::unique_ptr<uint8_t[]> rows =
      Decompress(png, png.Stride(pixel_bytes) * png.height, &has_more);
  if (has_more) return decoded;
  cv::Mat image, color;
  bool is_read = rows != nullptr;
  if (is_read && use == PngUse::kDepth) {
    image.create(png.height, png.width, CV_16UC1);
    is_read = ReadDepth(png, rows.get(), &image);
  } else if (is_read) {
    image.create(png.height, png.width, CV_8UC1);
    if (use == PngUse::kGrayAndColor) color.create(image.size(), CV_8UC3);
    is_read = is_rgb ? ReadGray<3>(png, rows.get(), &image, &color)
                     : ReadGray<1>(png, rows.get(), &image, &color);
  }
  if (is_read) return {image, color, /*is_damaged=*/false};
  decoded.is_damaged = true;
  return decoded;
}

}  // namespace rgbd_pose
