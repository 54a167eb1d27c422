#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// The frames of a live camera, of which only the newest is kept; those that a
// slower caller misses are counted. A separate thread reads the camera.
class LatestFrame final : public FrameSource {
 public:
  // Starts to read the camera at once.
  explicit LatestFrame(std::unique_ptr<FrameSource> camera);

  // Waits until the camera has delivered its next frame.
  ~LatestFrame() override;

  // Waits for a frame that was not returned yet. Rethrows the camera's error.
  std::optional<RgbdFrame> Next() override;

  const RgbdCamera& camera() const override { return camera_->camera(); }
  Trajectory ground_truth() const override { return camera_->ground_truth(); }
  int unmatched_color() const override { return camera_->unmatched_color(); }
  int dropped() const override;

 private:
  void Run();

  std::unique_ptr<FrameSource> camera_;
  mutable std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  std::optional<RgbdFrame> newest_;
  std::exception_ptr error_;
  bool is_over_ = false;     // the camera gives no more frames
  bool is_closing_ = false;  // the destructor has been called
  int dropped_ = 0;
  int taken_ = 0;
  std::thread thread_;
};

}  // namespace rgbd_pose
