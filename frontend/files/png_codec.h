#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Four bytes, the highest first, as numbers stand in a PNG file.
inline std::string PngNumber(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<char>(value >> shift & 0xFF));
  }
  return bytes;
}

// How a PNG file of one channel begins, up to the checksum of its header: of so
// many pixels with so many bits, not interlaced (PNG Specification, sections
// 5.2 and 11.2.2).
inline std::string PngStart(int width, int height, int bits) {
  constexpr uint32_t kHeaderSize = 13;
  return "\x89PNG\r\n\x1A\n" + PngNumber(kHeaderSize) + "IHDR" +
         PngNumber(width) + PngNumber(height) + static_cast<char>(bits) +
         std::string(4, '\0');
}

// How the image of a PNG file is wanted.
enum class PngUse {
  kGray,          // CV_8UC1
  kGrayAndColor,  // that, and CV_8UC3 in the order blue, green, red
  kDepth,         // CV_16UC1
  kOther,         // anything else: OpenCV's work
};

// What became of a PNG file.
struct DecodedPng {
  cv::Mat image;            // gray or depth; empty: see below
  cv::Mat color;            // empty unless asked for
  bool is_damaged = false;  // there is no point in asking OpenCV
};

// Decodes the kinds of PNG that RGB-D recordings consist of, by libdeflate in
// about half the time that OpenCV takes, to the very values that it gives:
// three channels of 8 bits or one to gray, one channel of 16 bits to depth. The
// header says which kind it is. Other kinds are left to OpenCV, which has the
// sole work of decompressing them.
//
// A file is damaged that begins as a PNG and is cut off, has another checksum
// than it says in what is needed of it, more than 16384 x 16384 pixels or, of
// the kinds above, other than the rows of an image. (libpng would tell stderr
// about it.) May be called from several threads at once.
DecodedPng DecodePng(std::string_view bytes, PngUse use);

// The bytes of a grey (CV_8UC1) or depth image (CV_16UC1), which is not empty,
// as a PNG file: by libdeflate in about half the time that OpenCV takes for as
// many bytes. May be called from several threads at once.
std::string EncodePngByLibdeflate(const cv::Mat& image);

}  // namespace rgbd_pose
