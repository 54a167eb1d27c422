#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Whether a file starts as a PNG does.
bool IsPng(std::string_view bytes);

// Decodes a PNG of any kind: as it is, or as an image with four 16-bit or three
// 8-bit channels in the order blue, green, red (and alpha) if `to_color`.
// Throws InputError, which names the file, if it is damaged or cut off.
// png_decoder.h reads the usual kinds faster. Thread-safe.
cv::Mat DecodeAnyPng(const std::string& bytes, const std::string& path,
                     bool to_color);

// Encodes an image with 1 or 3 (blue, green, red) channels of 8 or 16 bits,
// with little compression, as the noise of a sensor hardly has any. Throws
// InputError for other images.
std::string EncodePng(const cv::Mat& image);

}  // namespace rgbd_pose
