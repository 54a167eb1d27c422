// W3C, Portable Network Graphics (PNG) Specification, second edition, 2003.

#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <new>
#include <vector>

#include "frontend/files/png_codec.h"

namespace rgbd_pose {
namespace {

std::string Checksum(std::string_view type_and_data) {
  return PngNumber(
      libdeflate_crc32(0, type_and_data.data(), type_and_data.size()));
}

std::string EncodedChunk(const std::string& type, const std::string& data) {
  return PngNumber(static_cast<uint32_t>(data.size())) + type + data +
         Checksum(type + data);
}

// The rows of an image, with the byte of the pixel to the left subtracted from
// each byte (section 9, filter Sub).
std::string FilteredRows(const cv::Mat& image) {
  constexpr char kSub = 1;
  const size_t pixel_bytes = image.elemSize();
  const size_t row_bytes = pixel_bytes * image.cols;
  std::string rows((1 + row_bytes) * image.rows, kSub);
  // A row with a pixel of zeros before it.
  std::vector<uint8_t> row(pixel_bytes + row_bytes, 0);
  char* to = rows.data();
  for (int y = 0; y < image.rows; ++y) {
    const uint8_t* from = image.ptr<uint8_t>(y);
    uint8_t* bytes = row.data() + pixel_bytes;
    if (pixel_bytes == 1) {
      std::copy(from, from + row_bytes, bytes);
    } else {
      const uint16_t* values = image.ptr<uint16_t>(y);
      for (int x = 0; x < image.cols; ++x) {
        bytes[2 * x] = static_cast<uint8_t>(values[x] >> 8);
        bytes[2 * x + 1] = static_cast<uint8_t>(values[x]);
      }
    }
    ++to;  // skip the filter type
    for (size_t i = 0; i < row_bytes; ++i) {
      *to++ = static_cast<char>(bytes[i] - row[i]);
    }
  }
  return rows;
}

std::string Compress(const std::string& bytes) {
  // The next levels take 50 % more time to save a few percent of size.
  constexpr int kFastest = 1;
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)>
      compressor(libdeflate_alloc_compressor(kFastest),
                 libdeflate_free_compressor);
  if (compressor == nullptr) throw std::bad_alloc();
  std::string compressed(
      libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  compressed.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(),
                                             bytes.size(), compressed.data(),
                                             compressed.size()));
  return compressed;
}

}  // namespace

std::string EncodePngByLibdeflate(const cv::Mat& image) {
  const std::string start =
      PngStart(image.cols, image.rows, static_cast<int>(8 * image.elemSize()));
  constexpr size_t kBeforeType = 12;  // signature and length
  return start + Checksum(std::string_view(start).substr(kBeforeType)) +
         EncodedChunk("IDAT", Compress(FilteredRows(image))) +
         EncodedChunk("IEND", "");
}

}  // namespace rgbd_pose
