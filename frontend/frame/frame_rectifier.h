#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Resamples frames whose rows were exposed one after another to images of one
// moment, as the same camera with a global shutter would have taken them. For
// frames that others are tracked against: whatever is made of them needs to
// know nothing of shutters. One object serves one thread; its memory is used
// again.
class FrameRectifier {
 public:
  // The camera of all frames.
  explicit FrameRectifier(const Camera& camera);

  // The frame at its stamp, its images its own. As it is (and its images
  // shared) where the velocity is not known or there is nothing to undo.
  Frame Rectify(const Frame& frame);

  // The same as seen from elsewhere nearby: `target_from_middle` of the camera
  // when the middle row of colour was exposed.
  Frame Rectify(const Frame& frame, const Rigid3d& target_from_middle);

 private:
  // How an image point at a node of a grid moves: by turn + shift / z px.
  struct Flow {
    std::array<float, 2> turn, shift;
  };

  void MakeFlows(const Frame& frame, const Rigid3d& target_from_middle);
  // Fills the maps. `depth`: as moved.
  void MakeMaps(const cv::Mat& depth, double depth_scale);

  Camera camera_;
  DepthWarper mover_;
  int columns_, rows_;                  // of nodes
  std::vector<Eigen::Vector3d> rays_;   // of nodes
  std::vector<Eigen::Vector2d> nodes_;  // where they are, px
  std::vector<Flow> flows_;             // at nodes
  cv::Mat map_u_, map_v_;               // where each pixel is read, px
};

}  // namespace rgbd_pose
