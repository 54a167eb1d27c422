#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Whether a file starts as a JPEG does.
bool IsJpeg(std::string_view bytes);

// Decodes a JPEG to grey values (CV_8UC1), as it stores them, or in colour
// (CV_8UC3 in the order blue, green, red). Throws InputError, which names the
// file, if it is damaged or cut off. Thread-safe.
cv::Mat DecodeJpeg(const std::string& bytes, const std::string& path,
                   bool to_gray);

// Encodes an image of one of these types; `quality`: up to 100.
std::string EncodeJpeg(const cv::Mat& image, int quality);

}  // namespace rgbd_pose
