#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// The frames of a camera that does not wait: one is kept, the newest. Who asks
// more slowly than frames come gets every second or third one, never an old
// one; the others are dropped and counted. A thread of its own asks the camera.
class LatestFrame final : public FrameSource {
 public:
  // Begins to ask at once.
  explicit LatestFrame(std::unique_ptr<FrameSource> camera);

  // Waits until the camera has given its next frame.
  ~LatestFrame() override;
  LatestFrame(const LatestFrame&) = delete;
  LatestFrame& operator=(const LatestFrame&) = delete;

  // The newest frame that was not given yet. Rethrows what the camera threw.
  std::optional<RgbdFrame> Next() override;

  const RgbdCamera& camera() const override { return camera_->camera(); }
  Trajectory ground_truth() const override { return camera_->ground_truth(); }
  int unmatched_color() const override { return camera_->unmatched_color(); }
  int dropped() const override;

 private:
  void Run();

  std::unique_ptr<FrameSource> camera_;
  mutable std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::optional<RgbdFrame> newest_;
  std::exception_ptr error_;
  bool is_over_ = false;     // the camera gives no more
  bool is_closing_ = false;  // nobody asks any more
  int dropped_ = 0;
  int taken_ = 0;
  std::thread thread_;
};

}  // namespace rgbd_pose
