#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Rectifies rolling-shutter frames that others are tracked against: resamples
// them to the images that the same camera with a global shutter would have
// taken. Not thread-safe; the object reuses its memory.
class FrameRectifier {
 public:
  // The camera of all frames.
  explicit FrameRectifier(const Camera& camera);

  // The frame at its stamp, with its own images. If the velocity is not known
  // or nothing has to be corrected, the frame is returned with shared images.
  Frame Rectify(const Frame& frame);

  // The same, seen from a pose nearby. A frame in which nothing has to be
  // corrected stays where it is.
  Frame Rectify(const Frame& frame, const Rigid3d& target_from_stamp);

 private:
  // The motion of an image point at a grid node: turn + shift / z, px.
  struct Flow {
    Eigen::Vector2f turn, shift;
  };

  // `target_from_middle`: from the camera at the exposure of the middle row.
  void MakeFlows(const Frame& frame, const Rigid3d& target_from_middle);
  // Fills the maps. `depth`: the warped depth image.
  void MakeMaps(const cv::Mat& depth, double depth_scale);

  Camera camera_;
  DepthWarper mover_;
  RayGrid nodes_;
  std::vector<Flow> flows_;  // at nodes
  cv::Mat map_u_, map_v_;    // source position of each pixel, px
};

}  // namespace rgbd_pose
