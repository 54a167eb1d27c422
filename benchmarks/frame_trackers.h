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

// A frame and what OpenCV's odometries want of it, made before the clock
// starts.
struct BenchmarkFrame {
  explicit BenchmarkFrame(const Frame& images);

  Frame frame;
  cv::Mat depth_m;  // CV_32FC1, m, NaN = none
};

// Tracks a camera frame by frame.
class FrameTracker {
 public:
  virtual ~FrameTracker() = default;

  // Takes the next frame; world_from_cam, where the world is the camera of the
  // first frame. Nothing if the frame could not be tracked.
  virtual std::optional<Rigid3d> Track(const BenchmarkFrame& frame) = 0;
};

struct FrameTrackerType {
  std::string name;
  std::unique_ptr<FrameTracker> (*make)(const Camera& camera);
};

// This project's odometry by features, by pixels and by both, otherwise with
// default settings; then, where OpenCV has
// its rgbd module, cv::rgbd's RgbdOdometry, ICPOdometry and RgbdICPOdometry,
// all with default settings and from frame to frame as in OpenCV's own sample:
// each frame is tracked against the one before, which keeps what was computed
// of it (pyramids, normals), and a frame that fails is taken as no motion;
// then, where it is installed, Open3D's (open3d_tracker.h).
std::vector<FrameTrackerType> FrameTrackerTypes();

}  // namespace rgbd_pose
