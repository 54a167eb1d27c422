#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "frontend/bags/ros_messages.h"

namespace rgbd_pose {

// What an image of ROS is, by its encoding or, compressed, by its format.
enum class RosImageUse {
  kColor,
  kGray,
  kDepth,        // whole numbers of 16 bits
  kMetricDepth,  // floating-point numbers, metres
  kGrayOrDepth,  // mono16 may be either
  kOther,        // cannot be read
};
RosImageUse UseOfEncoding(const std::string& encoding);

// Raw units per metre that depth in metres is stored with, unless something
// else is asked for: 0.2 mm, up to 13.1 m; what is farther has no depth.
constexpr double kMetricDepthScale = 5000.0;

// Decode an image; `name` is for messages. `image` is of a compressed message
// if it has no size. Throw InputError for one that is cut off, damaged or of
// an encoding that cannot be read.

// Gray values (CV_8UC1) and, unless null, colours (CV_8UC3: blue, green, red).
cv::Mat DecodeRosGray(const RosImage& image, const std::string& name,
                      cv::Mat* color);

// CV_16UC1; metres are multiplied by `depth_scale`, whole numbers stay.
cv::Mat DecodeRosDepth(const RosImage& image, const std::string& name,
                       double depth_scale);

}  // namespace rgbd_pose
