#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The part of the view in which the camera sees what carries it: a hand, a
// table or a robot's own body. It stands still in the image while the scene
// moves, and where it is textured, it agrees with a motion of its own: none.
// What has stood still in several frames is left out from then on.
class CarriedRegion {
 public:
  // Learns from a frame that was tracked well against a reference. Both with
  // their images as measured.
  void Learn(const Frame& ref, const Frame& cur, const Camera& camera,
             const Rigid3d& cur_from_ref);

  // Whether there is nothing to leave out.
  bool empty() const { return num_carried_ == 0; }

  // Returns a copy of a depth image (CV_16UC1) without depths in the region.
  cv::Mat WithoutRegion(const cv::Mat& depth) const;

 private:
  struct Cell {
    int still_frames = 0;  // in a row; a frame in which it moves begins again
    int forget_in = 0;     // frames; 0: not left out
  };

  int columns_ = 0;
  std::vector<Cell> cells_;  // row by row
  int num_carried_ = 0;
};

}  // namespace rgbd_pose
