#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "frontend/files/png_decoder.h"

namespace rgbd_pose {

// Colour types (section 11.2.2).
constexpr int kPngGray = 0;
constexpr int kPngRgb = 2;

// What the chunks of a PNG file say.
struct PngImage {
  int width = 0;
  int height = 0;
  int bit_depth = 0;
  int color_type = 0;
  bool is_interlaced = false;
  std::string compressed;

  // Bytes from row to row: a filter goes ahead.
  size_t Stride(int pixel_bytes) const {
    return 1 + static_cast<size_t>(pixel_bytes) * width;
  }
};

// What a file is, as far as its chunks tell.
enum class PngContent {
  kNoPng,
  kDamaged,
  kOther,  // an image of another kind than the use is of
  kOurs,
};

// Reads all chunks; of kOurs, `png` has the compressed bytes.
PngContent ReadPngChunks(std::string_view bytes, PngUse use, PngImage* png);

}  // namespace rgbd_pose
