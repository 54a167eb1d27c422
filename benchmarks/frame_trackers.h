#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A frame and the input of OpenCV's odometries, prepared before the clock
// starts.
struct BenchmarkFrame {
  explicit BenchmarkFrame(const Frame& images);

  Frame frame;
  cv::Mat depth_m;  // CV_32FC1, m; NaN: none
};

// Tracks a camera frame by frame.
class FrameTracker {
 public:
  virtual ~FrameTracker() = default;

  // Tracks the next frame. Returns world_from_cam, where the world is the
  // camera of the first frame, or nothing if tracking failed.
  virtual std::optional<Rigid3d> Track(const BenchmarkFrame& frame) = 0;
};

struct FrameTrackerType {
  std::string name;
  std::unique_ptr<FrameTracker> (*make)(const RgbdCamera& camera);
};

// This project's odometry on features, on pixels and on both, otherwise with
// default settings. If OpenCV has its rgbd module, also cv::rgbd's
// RgbdOdometry, ICPOdometry and RgbdICPOdometry with default settings, from
// frame to frame as in OpenCV's own sample: each frame is tracked against the
// previous one, whose computed data (pyramids, normals) are kept, and a failed
// frame counts as no motion. If Open3D is installed, also its odometry
// (open3d_tracker.h).
std::vector<FrameTrackerType> FrameTrackerTypes();

}  // namespace rgbd_pose
