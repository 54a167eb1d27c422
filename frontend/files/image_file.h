#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace rgbd_pose {

// Reads a whole image file. `flags` as for cv::imread, but an EXIF orientation
// is never applied: it would turn the image away from its camera model.
// Throws InputError naming the file where it cannot be read, is no image or is
// cut off. (Bytes changed inside a JPEG go unnoticed: it has no checksum.)
// May be called from several threads at once.
cv::Mat ReadImageFile(const std::string& path, int flags);

// Reads a colour or gray image as gray values (CV_8UC1) and, unless null, in
// colour (CV_8UC3 in the order blue, green, red; most PNG files need no second
// decoding). Throws InputError for one of other than 8 bits a channel, too: it
// would be a depth image.
cv::Mat ReadGrayImageFile(const std::string& path, cv::Mat* color = nullptr);

// Reads a depth image: 16 bits, one channel (CV_16UC1). Throws InputError for
// any other, too.
cv::Mat ReadDepthImageFile(const std::string& path);

// The same of the bytes of a file; `path` is for messages.
cv::Mat DecodeGrayImage(const std::string& bytes, const std::string& path,
                        cv::Mat* color = nullptr);
cv::Mat DecodeDepthImage(const std::string& bytes, const std::string& path);

// The bytes of an image as a PNG file; `settings` as for cv::imwrite. Without
// any, what takes least time: by libdeflate, if it is one of grey or depth.
std::string EncodePng(const cv::Mat& image,
                      const std::vector<int>& settings = {});

// Writes these, as a whole or not at all. Throws InputError if it cannot.
void WritePngFile(const std::string& path, const cv::Mat& image,
                  const std::vector<int>& settings = {});

// The grey level of a colour, 0.299 R + 0.587 G + 0.114 B rounded, as OpenCV's
// cvtColor has it: the same wherever an image comes from.
inline uint8_t GrayLevel(int red, int green, int blue) {
  // In 15 bits; they add up to 1.
  return static_cast<uint8_t>(
      (9798 * red + 19235 * green + 3735 * blue + (1 << 14)) >> 15);
}

}  // namespace rgbd_pose
