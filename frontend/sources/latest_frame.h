#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// The frames of a live camera, of which only the newest is kept; those that a
// slower caller misses are counted. A separate thread reads the camera.
class LatestFrame final : public FrameSource {
 public:
  // Starts to read the camera at once.
  explicit LatestFrame(std::unique_ptr<FrameSource> camera)
      : camera_(std::move(camera)), thread_(&LatestFrame::Run, this) {}

  // Waits until the camera has delivered its next frame.
  ~LatestFrame() override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_closing_ = true;
    }
    thread_.join();
  }

  // Waits for a frame that was not returned yet. Rethrows the camera's error.
  std::optional<RgbdFrame> Next() override {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return newest_.has_value() || is_over_; });
    if (newest_.has_value()) {
      return std::exchange(newest_, std::nullopt)->WithIndex(taken_++);
    }
    if (error_ != nullptr) {
      std::rethrow_exception(std::exchange(error_, nullptr));
    }
    return std::nullopt;
  }

  const RgbdCamera& camera() const override { return camera_->camera(); }
  Trajectory ground_truth() const override { return camera_->ground_truth(); }
  std::optional<ImuSensor> imu() const override { return camera_->imu(); }
  int unmatched_color() const override { return camera_->unmatched_color(); }
  int dropped() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return dropped_;
  }

 private:
  void Run() {
    while (true) {
      std::optional<RgbdFrame> next;
      std::exception_ptr error;
      try {
        next = camera_->Next();
      } catch (...) {
        error = std::current_exception();
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      is_over_ = !next.has_value() || is_closing_;
      error_ = error;
      if (next.has_value()) {
        if (newest_.has_value()) {
          ++dropped_;
          // Its inertial samples are those before the ones of the next frame.
          next->imu.insert(next->imu.begin(), newest_->imu.begin(),
                           newest_->imu.end());
        }
        newest_ = std::move(next);
      }
      changed_.notify_all();
      if (is_over_) return;
    }
  }

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
