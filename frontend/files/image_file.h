#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace rgbd_pose {

// No image may be wider or higher, in px. More than any camera has; keeps a few
// wrong bytes from allocating all memory.
inline constexpr int kMaxImageSide = 1 << 14;

// Reads an image file as it is. An EXIF orientation is never applied, as the
// rotated image would not match its camera model. Throws InputError, which
// names the file, if it cannot be read, is no image or is cut off. (Changed
// bytes inside a JPEG are not detected: it has no checksum.) Thread-safe.
cv::Mat ReadImageFile(const std::string& path);

// Reads a colour or gray image as gray values (CV_8UC1) and, unless `color` is
// null, in colour (CV_8UC3 in the order blue, green, red). Also throws
// InputError for other than 8 bits per channel, as in depth images.
cv::Mat ReadGrayImageFile(const std::string& path, cv::Mat* color = nullptr);

// Reads a depth image (CV_16UC1). Also throws InputError for any other type.
cv::Mat ReadDepthImageFile(const std::string& path);

// The same for the bytes of a file; `path` is used in error messages.
cv::Mat DecodeGrayImage(const std::string& bytes, const std::string& path,
                        cv::Mat* color = nullptr);
cv::Mat DecodeDepthImage(const std::string& bytes, const std::string& path);

// Writes a PNG file completely or not at all. Throws InputError on failure.
void WritePngFile(const std::string& path, const cv::Mat& image);

// The grey level of a colour: 0.299 R + 0.587 G + 0.114 B, rounded. OpenCV's
// cvtColor gives the same values, so the source of an image does not matter.
inline uint8_t GrayLevel(int red, int green, int blue) {
  // Weights in fixed point with 15 bits; they add up to 1.
  return static_cast<uint8_t>(
      (9798 * red + 19235 * green + 3735 * blue + (1 << 14)) >> 15);
}

}  // namespace rgbd_pose
