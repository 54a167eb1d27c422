#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

#include "core/geometry/twist.h"

namespace rgbd_pose {

// One RGB-D image pair of a sequence.
struct Frame {
  int index = 0;                // index in the source, from 0
  double timestamp = 0.0;       // of the colour image, s
  double depth_delay = 0.0;     // stamp of depth minus stamp of colour, s
  cv::Mat gray = {};            // CV_8UC1
  cv::Mat depth = {};           // CV_16UC1, registered to gray, the same size
  double depth_scale = 5000.0;  // raw depth units per metre

  // Exposure times of the rows, relative to the stamp of each image.
  Shutter color_shutter = {};
  Shutter depth_shutter = {};

  // Velocity of the camera at the time stamp; nothing if unknown.
  std::optional<Twist> twist = {};

  // CV_8UC3 (BGR), of the size of gray; empty unless the source keeps colours.
  cv::Mat color = {};

  // Depth at a pixel, m; 0 if there is none.
  double DepthAt(int column, int row) const {
    const uint16_t raw = depth.at<uint16_t>(row, column);
    return raw == kNoDepth ? 0.0 : raw / depth_scale;
  }

  // Whether all rows of both images were exposed at the time stamp. Differences
  // of stamps are ignored below 0.1 ms (half a pixel at 360 degrees per second)
  // and above 50 ms, as they come from clocks that disagree.
  bool IsOneMoment() const {
    return color_shutter.IsGlobal() && DepthShutter().IsGlobal();
  }

  // Whether the exposure times of the rows are known.
  bool HasKnownTimes() const {
    return color_shutter.is_known || !color_shutter.IsGlobal() ||
           !depth_shutter.IsGlobal();
  }

  // Exposure times of the rows of depth, relative to the stamp of colour.
  Shutter DepthShutter() const {
    const double delay = std::abs(depth_delay);
    const bool counts = delay > 1e-4 && delay < 0.05;
    return {depth_shutter.offset + (counts ? depth_delay : 0.0),
            depth_shutter.readout};
  }

  // The timing to correct for; no effect if the velocity is not known.
  FrameTiming Timing() const {
    return twist.has_value() ? Timing(*twist) : FrameTiming();
  }
  // The same for a given velocity.
  FrameTiming Timing(const Twist& velocity) const {
    return {color_shutter, DepthShutter(), velocity};
  }

  // A copy with its own images, but without colours.
  Frame Clone() const {
    Frame clone = *this;
    clone.gray = gray.clone();
    clone.depth = depth.clone();
    clone.color.release();
    return clone;
  }

  // Some sensors mark missing measurements by the largest value instead of 0.
  static constexpr uint16_t kNoDepth = 65535;
};

}  // namespace rgbd_pose
