#include "frontend/files/png_codec.h"

#include <spng.h>

#include <cstdlib>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "core/util/input_error.h"
#include "frontend/files/image_file.h"

namespace rgbd_pose {
namespace {

using Context = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

// More than any text or table beside an image takes, in bytes.
constexpr size_t kMaxChunk = 1 << 24;

// zlib's strategy that only looks for runs of one byte (Z_RLE in zlib.h).
constexpr int kRuns = 3;

// A format of the decoder and the type of its images.
struct Format {
  int format;
  int type;
};

Format FormatOf(const spng_ihdr& header, bool to_color) {
  const bool is_deep = header.bit_depth == 16;
  const bool is_gray = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE;
  const bool is_rgb = header.color_type == SPNG_COLOR_TYPE_TRUECOLOR;
  const bool is_indexed = header.color_type == SPNG_COLOR_TYPE_INDEXED;
  if (is_gray && !to_color) {
    return is_deep ? Format{SPNG_FMT_PNG, CV_16UC1}
                   : Format{SPNG_FMT_G8, CV_8UC1};
  }
  if (!is_deep && (to_color || is_rgb || is_indexed)) {
    return {SPNG_FMT_RGB8, CV_8UC3};
  }
  if (is_rgb && !to_color) return {SPNG_FMT_PNG, CV_16UC3};
  return is_deep ? Format{SPNG_FMT_RGBA16, CV_16UC4}
                 : Format{SPNG_FMT_RGBA8, CV_8UC4};
}

// The file has red first, OpenCV blue.
cv::Mat WithRedAndBlueSwapped(const cv::Mat& image) {
  if (image.channels() < 3) return image;
  cv::Mat swapped;
  cv::cvtColor(image, swapped,
               image.channels() == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
  return swapped;
}

}  // namespace

bool IsPng(std::string_view bytes) {
  return bytes.rfind("\x89PNG\r\n\x1A\n", 0) == 0;
}

cv::Mat DecodeAnyPng(const std::string& bytes, const std::string& path,
                     bool to_color) {
  const auto check = [&path](int error) {
    if (error == 0) return;
    throw InputError(path + ": is damaged or cut off (" + spng_strerror(error) +
                     "); copy it again");
  };
  const Context png(spng_ctx_new(0), spng_ctx_free);
  check(spng_set_image_limits(png.get(), kMaxImageSide, kMaxImageSide));
  check(spng_set_chunk_limits(png.get(), kMaxChunk, kMaxChunk));
  check(spng_set_crc_action(png.get(), SPNG_CRC_ERROR, SPNG_CRC_DISCARD));
  check(spng_set_png_buffer(png.get(), bytes.data(), bytes.size()));
  spng_ihdr header = {};
  check(spng_get_ihdr(png.get(), &header));
  const Format format = FormatOf(header, to_color);
  cv::Mat image(static_cast<int>(header.height), static_cast<int>(header.width),
                format.type);
  check(spng_decode_image(png.get(), image.data,
                          image.total() * image.elemSize(), format.format, 0));
  check(spng_decode_chunks(png.get()));
  // The library does not look at the checksum of the last chunk.
  if (bytes.find("IEND\xAE\x42\x60\x82") == std::string::npos) {
    check(SPNG_IO_EOF);
  }
  return WithRedAndBlueSwapped(image);
}

std::string EncodePng(const cv::Mat& image) {
  const Context png(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, 1);
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_STRATEGY, kRuns);
  spng_set_option(png.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB);
  spng_ihdr header = {};
  header.width = image.cols;
  header.height = image.rows;
  header.bit_depth = image.depth() == CV_16U ? 16 : 8;
  header.color_type = image.channels() == 1 ? SPNG_COLOR_TYPE_GRAYSCALE
                                            : SPNG_COLOR_TYPE_TRUECOLOR;
  spng_set_ihdr(png.get(), &header);
  cv::Mat pixels = WithRedAndBlueSwapped(image);
  if (!pixels.isContinuous()) pixels = pixels.clone();
  int error = spng_encode_image(png.get(), pixels.data,
                                pixels.total() * pixels.elemSize(),
                                SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  size_t size = 0;
  const std::unique_ptr<void, void (*)(void*)> data(
      error == 0 ? spng_get_png_buffer(png.get(), &size, &error) : nullptr,
      std::free);
  if (error != 0) {
    throw InputError(std::string("an image cannot be encoded as PNG: ") +
                     spng_strerror(error));
  }
  return {static_cast<const char*>(data.get()), size};
}

}  // namespace rgbd_pose
