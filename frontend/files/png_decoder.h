#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rgbd_pose {

// The start of a PNG file with one channel of `bits` bits, not interlaced, up
// to the checksum of its header (PNG Specification, sections 5.2 and 11.2.2).
inline std::string PngStart(int width, int height, int bits) {
  std::string start = "\x89PNG\r\n\x1A\n";
  const auto add = [&start](uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8) {
      start.push_back(static_cast<char>(number >> shift & 0xFF));
    }
  };
  add(13);  // size of the header
  start += "IHDR";
  add(width);
  add(height);
  return start + static_cast<char>(bits) + std::string(4, '\0');
}

// What a PNG file is decoded to.
enum class PngUse {
  kGray,          // CV_8UC1
  kGrayAndColor,  // also CV_8UC3 in the order blue, green, red
  kDepth,         // CV_16UC1
};

struct DecodedPng {
  cv::Mat image;            // gray or depth; empty: not decoded
  cv::Mat color;            // empty unless requested
  bool is_damaged = false;  // another decoder need not be tried
};

// Decodes the kinds of PNG used in RGB-D recordings by libdeflate, in about
// half the time of libspng, to identical values: three channels or one of 8
// bits to gray, one channel of 16 bits to depth. Other kinds are left to
// png_codec.h. A file that begins as a PNG is damaged if it is cut off, if a
// checksum of a needed chunk is wrong, if a side has more than 16384 pixels or,
// for the kinds above, if bytes of the rows are missing or invalid.
// Thread-safe.
DecodedPng DecodePng(std::string_view bytes, PngUse use);

}  // namespace rgbd_pose
