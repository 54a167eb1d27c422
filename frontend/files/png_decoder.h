#pragma once

#include <opencv2/core.hpp>
#include <string_view>

namespace rgbd_pose {

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

}  // namespace rgbd_pose
