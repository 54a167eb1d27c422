#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

#include "frontend/bags/ros_messages.h"

namespace rgbd_pose {

// What a ROS image holds, by its encoding or, if it is compressed, its format.
enum class RosImageUse {
  kColor,
  kRawColor,  // as a sensor or a webcam sends it: a pattern, or YUV
  kGray,
  kDepth,        // 16-bit integers
  kMetricDepth,  // floating-point values, metres
  kGrayOrDepth,  // mono16 may be either
  kOther,        // cannot be read
};
RosImageUse UseOfEncoding(std::string_view encoding);

// Default scale to which depth in metres is converted, raw units per metre.
// Pixels farther than 13.1 m get no depth.
constexpr double kMetricDepthScale = 5000.0;

// Decode an image; `name` is used in error messages. An `image` without a size
// is from a compressed message. Throw InputError if the image is cut off,
// damaged or of an encoding that cannot be read.

// Gray values (CV_8UC1) and, unless null, colours (CV_8UC3: blue, green, red).
cv::Mat DecodeRosGray(const RosImage& image, const std::string& name,
                      cv::Mat* color);

// CV_16UC1. Metres are multiplied by `depth_scale`; integers are unchanged.
cv::Mat DecodeRosDepth(const RosImage& image, const std::string& name,
                       double depth_scale);

}  // namespace rgbd_pose
