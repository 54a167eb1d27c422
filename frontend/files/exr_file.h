#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rgbd_pose {

// Reads the only channel of an OpenEXR file, depths in metres, as raw units
// (CV_16UC1) of `per_metre` per metre; 0 where there is none. Throws InputError
// for files that cannot be read or have another number of channels, and in a
// build without OpenEXR. Thread-safe.
cv::Mat ReadExrDepth(const std::string& path, double per_metre);

}  // namespace rgbd_pose
