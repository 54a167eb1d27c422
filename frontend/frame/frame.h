#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

#include "core/geometry/twist.h"

namespace rgbd_pose {

// One RGB-D image pair of a sequence.
struct Frame {
  int index = 0;                // place in its source, from 0
  double timestamp = 0.0;       // of the colour image, seconds
  double depth_delay = 0.0;     // of depth's own stamp, seconds after it
  cv::Mat gray;                 // CV_8UC1
  cv::Mat depth;                // CV_16UC1, registered to gray, the same size
  double depth_scale = 5000.0;  // raw depth units per metre

  // When rows were exposed, from the stamp of each image.
  Shutter color_shutter = {};
  Shutter depth_shutter = {};

  // The camera's velocity at the time stamp; nothing: not known.
  std::optional<Twist> twist = {};

  // Of gray's size, CV_8UC3 in the order blue, green, red; empty unless its
  // source was asked to keep it.
  cv::Mat color;

  // Depth in metres at a whole pixel; 0 where there is none.
  double DepthAt(int column, int row) const {
    const uint16_t raw = depth.at<uint16_t>(row, column);
    return raw == kNoDepth ? 0.0 : raw / depth_scale;
  }

  // Whether both images were taken at the time stamp. Stamps that differ by
  // less than 0.1 ms do not count: not even a turn of 360 degrees a second
  // moves anything by half a pixel meanwhile. Beyond 50 ms they are of clocks
  // that disagree.
  bool IsOneMoment() const {
    return color_shutter.IsGlobal() && DepthShutter().IsGlobal();
  }

  // Whether somebody says when its rows were exposed.
  bool HasKnownTimes() const {
    return color_shutter.is_known || !color_shutter.IsGlobal() ||
           !depth_shutter.IsGlobal();
  }

  // When depth was taken, from the stamp of colour.
  Shutter DepthShutter() const {
    const double delay = std::abs(depth_delay);
    const bool counts = delay > 1e-4 && delay < 0.05;
    return {depth_shutter.offset + (counts ? depth_delay : 0.0),
            depth_shutter.readout};
  }

  // What has to be undone; nothing where the velocity is not known.
  FrameTiming Timing() const {
    return twist.has_value() ? Timing(*twist) : FrameTiming();
  }
  // The same with a velocity.
  FrameTiming Timing(const Twist& velocity) const {
    return {color_shutter, DepthShutter(), velocity};
  }

  // The same with images of its own, but no colours.
  Frame Clone() const {
    Frame clone = *this;
    clone.gray = gray.clone();
    clone.depth = depth.clone();
    clone.color.release();
    return clone;
  }

  // Some sensors mark "no measurement" by the largest value instead of 0.
  static constexpr uint16_t kNoDepth = 65535;
};

}  // namespace rgbd_pose
