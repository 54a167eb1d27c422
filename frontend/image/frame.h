#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

namespace rgbd_pose {

// One RGB-D image pair of a sequence.
struct Frame {
  int index = 0;                // place in its source, from 0
  double timestamp = 0.0;       // of the colour image, seconds
  double depth_delay = 0.0;     // of the depth image, seconds after it
  cv::Mat gray;                 // CV_8UC1
  cv::Mat depth;                // CV_16UC1, registered to gray, the same size
  double depth_scale = 5000.0;  // raw depth units per metre

  // Of gray's size, CV_8UC3 in the order blue, green, red; empty unless its
  // source was asked to keep it.
  cv::Mat color;

  // Depth in metres at a whole pixel; 0 where there is none.
  double DepthAt(int column, int row) const {
    const uint16_t raw = depth.at<uint16_t>(row, column);
    return raw == kNoDepth ? 0.0 : raw / depth_scale;
  }

  // Some sensors mark "no measurement" by the largest value instead of 0.
  static constexpr uint16_t kNoDepth = 65535;
};

// A frame with what whoever tracks it needs of it alone (a pyramid, say): made
// by the frontend that is to use it, which knows what has been added. It shares
// the images, which must stay as they are for as long as it is in use. Nothing
// of depth is prepared: that is moved to the time of colour once the motion is
// known.
struct PreparedFrame : Frame {
  // With nothing added yet.
  explicit PreparedFrame(const Frame& frame) : Frame(frame) {}
  virtual ~PreparedFrame() = default;

  // One of the same type, that shares the images.
  virtual std::unique_ptr<PreparedFrame> Copy() const {
    return std::make_unique<PreparedFrame>(*this);
  }
};

}  // namespace rgbd_pose
