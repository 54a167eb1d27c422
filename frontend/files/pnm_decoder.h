#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Whether a file starts as a binary PGM or PPM does.
bool IsPnm(std::string_view bytes);

// Decodes a binary PGM (grey, P5) or PPM (colour, P6) with 8 or 16 bits as it
// is; colours are in the order blue, green, red. Throws InputError, which names
// the file, if it is damaged or cut off.
cv::Mat DecodePnm(const std::string& bytes, const std::string& path);

}  // namespace rgbd_pose
