#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_pose {

// One RGB-D image pair of a sequence.
struct Frame {
  int index = 0;                // place in its dataset, from 0
  double timestamp = 0.0;       // of the colour image, seconds
  cv::Mat gray;                 // CV_8UC1
  cv::Mat depth;                // CV_16UC1, registered to gray, the same size
  double depth_scale = 5000.0;  // raw depth units per metre

  // What a frontend has worked out ahead: its own pyramid of `gray`, or empty.
  std::vector<cv::Mat> pyramid;

  // Depth in metres at a whole pixel; 0 where there is none.
  double DepthAt(int column, int row) const {
    const uint16_t raw = depth.at<uint16_t>(row, column);
    return raw == kNoDepth ? 0.0 : raw / depth_scale;
  }

  // Some sensors mark "no measurement" by the largest value instead of 0.
  static constexpr uint16_t kNoDepth = 65535;
};

}  // namespace rgbd_pose
