#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rgbd_pose {

// Reads a whole image file. `flags` as for cv::imread, but an EXIF orientation
// is never applied: it would turn the image away from its camera model.
// Throws InputError naming the file where it cannot be read, is no image or is
// cut off. (Bytes changed inside a JPEG go unnoticed: it has no checksum.)
// May be called from several threads at once.
cv::Mat ReadImageFile(const std::string& path, int flags);

// Reads a depth image: 16 bits, one channel (CV_16UC1). Throws InputError for
// any other, too.
cv::Mat ReadDepthImageFile(const std::string& path);

}  // namespace rgbd_pose
