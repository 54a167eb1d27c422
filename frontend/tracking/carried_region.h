#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// The part of the view in which the camera sees what carries it: a hand, a
// table or a robot's own body. It stands still in the image while the scene
// moves, and where it is textured, features on it agree with a motion of their
// own: none. What has stood still in several frames is left out from then on.
class CarriedRegion {
 public:
  // One vote of a feature: where it is in the image, and whether it stood still
  // although the motion should have moved it.
  struct Vote {
    cv::Point2f at;  // px
    bool is_still = false;
  };

  // Learns from the features of a frame that was tracked well.
  void Learn(const cv::Size& image, const std::vector<Vote>& votes);

  // Whether there is anything to leave out.
  bool empty() const { return num_carried_ == 0; }

  // Returns a copy of a depth image (CV_16UC1) without depths in the region.
  cv::Mat WithoutRegion(const cv::Mat& depth) const;

 private:
  struct Cell {
    int still_frames = 0;  // in a row; one that moves begins again
    int forget_in = 0;     // frames; 0: not left out
  };

  int columns_ = 0;
  std::vector<Cell> cells_;  // row by row
  int num_carried_ = 0;
};

}  // namespace rgbd_pose
