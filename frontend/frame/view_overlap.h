#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// How much of one view is visible in another one.
struct Overlap {
  double share = 0.0;    // visible share of the samples, 0 to 1
  double flow_px = 0.0;  // mean motion of the visible samples, px
  double zoom = 1.0;     // mean magnification in the other view
};

// Similarity of two views at the samples visible in both.
struct ViewLikeness {
  double gray = 0.0;   // correlation, -1 to 1; 0 if one view has no contrast
  double depth = 0.0;  // share of samples whose depths agree, 0 to 1
};

// Sparse 3D samples of a view, to find out how much of it other views see.
class ViewOverlap {
 public:
  ViewOverlap() = default;  // no samples

  // Samples a frame every `step_px` pixels where depth is within limits (m).
  ViewOverlap(const Frame& frame, const Camera& camera, int step_px,
              double min_depth, double max_depth);

  // The similarity of the view and the frame `cur`. `view` and `level`: images
  // of the view and of `cur` (CV_8UC1) at the same small pyramid level.
  ViewLikeness LikenessTo(const Frame& cur, const cv::Mat& view,
                          const cv::Mat& level,
                          const Rigid3d& cur_from_view) const;

  // How much of the view a camera at this pose should see. Occlusion is not
  // known, but if the viewing directions of a point differ by more than 60
  // degrees, it counts as invisible: the camera would see another surface.
  Overlap SeenFrom(const Rigid3d& cur_from_view) const;

  size_t size() const { return points_.size(); }

 private:
  Camera camera_;
  std::vector<Eigen::Vector3d> points_;  // in the axes of the view, m
};

}  // namespace rgbd_pose
