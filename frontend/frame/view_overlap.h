#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// How much of one view another one shows.
struct Overlap {
  double share = 0.0;    // 0 to 1
  double flow_px = 0.0;  // mean distance to where it was, px
  double zoom = 1.0;     // mean of how much larger things look there
};

// How alike two views look where one shows samples of the other.
struct ViewLikeness {
  double gray = 0.0;   // correlation, -1 to 1; 0 where one of them is blank
  double depth = 0.0;  // share of samples whose depths agree, 0 to 1
};

// Points of a view, far apart: enough to tell what of it others see.
class ViewOverlap {
 public:
  // None.
  ViewOverlap() = default;

  // Of a frame, at pixels so far apart that have a depth between the two (m).
  ViewOverlap(const Frame& frame, const Camera& camera, int step_px,
              double min_depth, double max_depth);

  // How alike the view and what a camera there sees look. `view` and `level`:
  // the same small level of both pyramids (CV_8UC1).
  ViewLikeness LikenessTo(const Frame& cur, const cv::Mat& view,
                          const cv::Mat& level,
                          const Rigid3d& cur_from_view) const;

  // How much of it a camera there should see. What hides what is not known, but
  // what is looked at from another side (by 60 degrees) is another surface.
  Overlap SeenFrom(const Rigid3d& cur_from_view) const;

  size_t size() const { return points_.size(); }

 private:
  Camera camera_;
  std::vector<Eigen::Vector3d> points_;  // in the view's axes, m
};

}  // namespace rgbd_pose
