// W3C, Portable Network Graphics (PNG) Specification, second edition, 2003.

#include "frontend/sources/png_decoder.h"

#include <libdeflate.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace rgbd_pose {
namespace {

// Colour types (section 11.2.2).
constexpr int kGray = 0;
constexpr int kRgb = 2;

// Far beyond any depth camera: a few wrong bytes must not claim all memory.
constexpr uint32_t kMaxSide = 1 << 14;

// The filters of section 9 count from 0.
constexpr int kLastFilter = 4;

struct Png {
  int width = 0;
  int height = 0;
  int bit_depth = 0;
  int color_type = 0;
  bool is_interlaced = false;
  std::string compressed;
};

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

bool ReadHeader(std::string_view header, Png* png) {
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
  // There is one kind of compression, one of filtering, two of interlacing.
  return data[10] == 0 && data[11] == 0 && data[12] <= 1;
}

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* decompressor) const {
    libdeflate_free_decompressor(decompressor);
  }
};

// Decompresses an image of `size` bytes; null if there are fewer or they are
// damaged. `has_more` says whether there are more.
std::unique_ptr<uint8_t[]> Decompress(const Png& png, size_t size,
                                      bool* has_more) {
  // The format packs no tighter; the memory for a claim is not taken unseen.
  constexpr size_t kMaxRatio = 1032;
  if (size / kMaxRatio > png.compressed.size()) return nullptr;
  std::unique_ptr<uint8_t[]> rows(new uint8_t[size]);
  const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
      libdeflate_alloc_decompressor());
  if (decompressor == nullptr) return nullptr;
  const libdeflate_result result = libdeflate_zlib_decompress(
      decompressor.get(), png.compressed.data(), png.compressed.size(),
      rows.get(), size, nullptr);
  *has_more = result == LIBDEFLATE_INSUFFICIENT_SPACE;
  if (result != LIBDEFLATE_SUCCESS && !*has_more) return nullptr;
  return rows;
}

// False for a damaged file, and for one that holds what would change the values
// of its pixels, such as a colour space.
bool ReadChunks(std::string_view bytes, Png* png) {
  if (!SkipSignature(&bytes)) return false;
  png->compressed.reserve(bytes.size());
  Chunk chunk;
  bool is_first = true;
  while (NextChunk(&bytes, &chunk) && chunk.is_intact &&
         (chunk.type == "IHDR") == is_first) {
    is_first = false;
    if (chunk.type == "IEND") return true;
    if (chunk.type == "IDAT") {
      png->compressed += chunk.data;
    } else if (chunk.type == "IHDR") {
      if (!ReadHeader(chunk.data, png) || png->is_interlaced) return false;
    } else if (chunk.type != "pHYs" && chunk.type != "tIME" &&
               chunk.type != "tEXt") {
      return false;
    }
  }
  return false;
}

// The neighbour nearest to left + up - up_left. Chosen without branches: what
// they would depend on is noise.
int PaethPredictor(int left, int up, int up_left) {
  const int left_distance = std::abs(up - up_left);
  const int up_distance = std::abs(left - up_left);
  const int up_left_distance = std::abs(left + up - 2 * up_left);
  const int nearer = up_distance <= up_left_distance ? up : up_left;
  const bool is_left =
      (left_distance <= up_distance) & (left_distance <= up_left_distance);
  return is_left ? left : nearer;
}

// Adds to each byte of a row what its neighbours predict, all channels abreast.
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

// Undoes a filter of section 9. False for one that does not exist.
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

// Decompresses the image and hands its rows to `convert(row, y)`.
template <int kPixelBytes, typename Convert>
bool ReadRows(const Png& png, Convert convert) {
  const int size = kPixelBytes * png.width;
  const size_t stride = 1 + static_cast<size_t>(size);  // a filter ahead
  const size_t total = stride * png.height;
  bool has_more = false;
  const std::unique_ptr<uint8_t[]> rows = Decompress(png, total, &has_more);
  if (rows == nullptr || has_more) return false;
  const std::vector<uint8_t> above_first(size, 0);
  const uint8_t* up_row = above_first.data();
  for (int y = 0; y < png.height; ++y) {
    uint8_t* row = rows.get() + y * stride + 1;
    if (!Unfilter<kPixelBytes>(row[-1], up_row, row, size)) return false;
    convert(row, y);
    up_row = row;
  }
  return true;
}

// Whether the compressed data of an image of any kind, but not interlaced, hold
// all its rows.
bool HasItsRows(const Png& png) {
  constexpr int kChannels[] = {1, 0, 3, 1, 2, 0, 4};  // by colour type
  const int channels = png.color_type <= 6 ? kChannels[png.color_type] : 0;
  if (channels == 0 || png.bit_depth < 1 || png.bit_depth > 16) return false;
  const size_t row_bits = static_cast<size_t>(png.width) * channels *
                          static_cast<size_t>(png.bit_depth);
  const size_t stride = 1 + (row_bits + 7) / 8;
  bool has_more = false;  // is no harm
  const std::unique_ptr<uint8_t[]> rows =
      Decompress(png, stride * png.height, &has_more);
  if (rows == nullptr) return false;
  for (int y = 0; y < png.height; ++y) {
    if (rows[stride * y] > kLastFilter) return false;
  }
  return true;
}

}  // namespace

bool IsDamagedPng(std::string_view bytes) {
  if (!SkipSignature(&bytes)) return false;
  Png png;
  bool is_first = true;
  Chunk chunk;
  while (NextChunk(&bytes, &chunk)) {
    // A capital letter marks chunks that are needed to show the image.
    const bool is_critical = (chunk.type[0] & 0x20) == 0;
    if (is_critical && !chunk.is_intact) return true;
    if (is_first && (chunk.type != "IHDR" || !ReadHeader(chunk.data, &png))) {
      return true;
    }
    is_first = false;
    if (chunk.type == "IDAT") png.compressed += chunk.data;
    if (chunk.type == "IEND") return !png.is_interlaced && !HasItsRows(png);
  }
  return true;
}

cv::Mat DecodePngToGray(std::string_view bytes) {
  Png png;
  if (!ReadChunks(bytes, &png) || png.bit_depth != 8 ||
      png.color_type != kRgb) {
    return cv::Mat();
  }
  cv::Mat gray(png.height, png.width, CV_8UC1);
  const bool read = ReadRows<3>(png, [&gray](const uint8_t* rgb, int y) {
    uint8_t* to = gray.ptr<uint8_t>(y);
    for (int x = 0; x < gray.cols; ++x, rgb += 3) {
      // 0.299 R + 0.587 G + 0.114 B in 15 bits, rounded down as libpng does,
      // which OpenCV leaves it to.
      to[x] = static_cast<uint8_t>(
          (9797 * rgb[0] + 19234 * rgb[1] + 3737 * rgb[2]) >> 15);
    }
  });
  return read ? gray : cv::Mat();
}

cv::Mat DecodePngDepth(std::string_view bytes) {
  Png png;
  if (!ReadChunks(bytes, &png) || png.bit_depth != 16 ||
      png.color_type != kGray) {
    return cv::Mat();
  }
  cv::Mat depth(png.height, png.width, CV_16UC1);
  const bool read = ReadRows<2>(png, [&depth](const uint8_t* row, int y) {
    uint16_t* to = depth.ptr<uint16_t>(y);
    for (int x = 0; x < depth.cols; ++x) {
      to[x] = static_cast<uint16_t>(row[2 * x] << 8 | row[2 * x + 1]);
    }
  });
  return read ? depth : cv::Mat();
}

}  // namespace rgbd_pose
