#pragma once

#include <opencv2/core.hpp>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// How many images were sent twice, see RepeatedImages.
struct RepeatedCounts {
  int color = 0;  // frames whose colour image is not new
  int depth = 0;  // frames whose depth image is not new
};

// Notices images that a driver has sent again under a new time stamp, as some
// do when they lag behind. What is equal to the last bit was not measured
// again: two images of a real camera differ by their noise. Images of one value
// (a dark room, a covered lens) may be equal all the same.
class RepeatedImages {
 public:
  // To be called for each frame in turn. Returns whether its colour or depth
  // image is the one before: what it shows is then of an earlier time, unless
  // the camera stood still or a recorder filled a gap.
  bool IsRepeated(const Frame& frame);

  // What was found so far.
  const RepeatedCounts& counts() const { return counts_; }

 private:
  cv::Mat gray_, depth_;  // of the frame before
  RepeatedCounts counts_;
};

}  // namespace rgbd_pose
