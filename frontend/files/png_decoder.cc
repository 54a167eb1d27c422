#include "frontend/files/png_decoder.h"

#include <libdeflate.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "frontend/files/png_chunks.h"
#include "frontend/files/png_format.h"
#include "frontend/frame/gray_level.h"

namespace rgbd_pose {
namespace {

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* decompressor) const {
    libdeflate_free_decompressor(decompressor);
  }
};

// Decompresses an image of `size` bytes; null if there are fewer or they are
// damaged. `has_more` says whether there are more.
std::unique_ptr<uint8_t[]> Decompress(const PngImage& png, size_t size,
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

// Undoes the filters of `rows` and hands each to `convert(row, y)`. False if a
// filter does not exist.
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

// Gray values, and colours unless `color` is empty.
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
