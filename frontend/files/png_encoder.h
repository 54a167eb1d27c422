#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rgbd_pose {

// The bytes of a grey (CV_8UC1) or depth image (CV_16UC1), which is not empty,
// as a PNG file: by libdeflate in about half the time that OpenCV takes for as
// many bytes. May be called from several threads at once.
std::string EncodePngByLibdeflate(const cv::Mat& image);

}  // namespace rgbd_pose
