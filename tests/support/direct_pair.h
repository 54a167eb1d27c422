#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/estimation/frame_view.h"
#include "core/estimation/motion_cost.h"
#include "core/geometry/depth_noise.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/image_pyramid.h"
#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {

// A rendered frame as direct costs see it. After changing its images, call
// Build() to rebuild the pyramid.
struct DirectFrame {
  DirectFrame(const Frame& rendered, const Camera& of_frame)
      : frame(rendered), camera(of_frame) {
    Build();
  }
  DirectFrame(const SyntheticDataset& dataset, int index)
      : DirectFrame(dataset.Read(index), dataset.camera().camera) {}

  void Build() {
    pyramid = SmoothPyramid(PreparedFrame(frame)).levels;
    const auto id = view.id;
    view = ViewFrame(frame, pyramid, camera,
                     *FindNamed(DepthNoiseModels(), "khoshelham"));
    view.id = id;
  }

  Frame frame;
  Camera camera;
  std::vector<cv::Mat> pyramid;
  FrameView view;
};

// Two frames of a rendered sequence and the exact motion between them.
struct DirectPair {
  DirectPair(const SyntheticDataset& dataset, int prev_index, int cur_index)
      : prev(dataset, prev_index),
        cur(dataset, cur_index),
        cur_from_prev(dataset.WorldFromCam(cur_index).Inverse() *
                      dataset.WorldFromCam(prev_index)) {}

  FramePair data() const {
    FramePair pair;
    pair.prev = &prev.view;
    pair.cur = &cur.view;
    return pair;
  }

  DirectFrame prev, cur;
  Rigid3d cur_from_prev;
};

// A small camera with the field of view of TUM's, with or without lens
// distortion.
inline SyntheticOptions SmallImages(bool is_distorted = false) {
  SyntheticOptions options;
  options.path = "handheld";
  options.frames = 60;
  Camera& camera = options.camera.camera;
  camera = CameraOfLevel(camera, 1);
  if (is_distorted) {
    camera.k1 = 0.1;
    camera.k2 = -0.2;
    camera.p1 = 0.002;
    camera.p2 = -0.003;
    camera.k3 = 0.1;
  }
  return options;
}

}  // namespace rgbd_pose
