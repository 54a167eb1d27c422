#pragma once

#include <opencv2/core.hpp>
#include <string_view>

namespace rgbd_pose {

// Decode the two kinds of PNG that RGB-D recordings consist of, by libdeflate
// in about half the time that OpenCV takes: three channels of 8 bits to gray
// (CV_8UC1, the very values that OpenCV gives), and one channel of 16 bits
// (CV_16UC1). Any other file, damaged or just uncommon, gives an empty image:
// it is left to OpenCV to read or to refuse.
// May be called from several threads at once.
cv::Mat DecodePngToGray(std::string_view bytes);
cv::Mat DecodePngDepth(std::string_view bytes);

// Whether a file begins as a PNG and is cut off, has another checksum than it
// says in what is needed of it, or holds other than the rows of an image, which
// has at most 16384 x 16384 pixels. (libpng would tell stderr about it.)
bool IsDamagedPng(std::string_view bytes);

}  // namespace rgbd_pose
