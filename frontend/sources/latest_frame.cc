#include "frontend/sources/latest_frame.h"

#include <utility>

namespace rgbd_pose {

LatestFrame::LatestFrame(std::unique_ptr<FrameSource> camera)
    : camera_(std::move(camera)), thread_(&LatestFrame::Run, this) {}

LatestFrame::~LatestFrame() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_closing_ = true;
  }
  thread_.join();
}

void LatestFrame::Run() {
  bool goes_on = true;
  while (goes_on) {
    std::optional<RgbdFrame> next;
    std::exception_ptr error;
    try {
      next = camera_->Next();
    } catch (...) {
      error = std::current_exception();
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      goes_on = next.has_value() && !is_closing_;
      is_over_ = !goes_on;
      error_ = error;
      if (next.has_value()) {
        if (newest_.has_value()) ++dropped_;
        newest_ = std::move(next);
      }
    }
    changed_.notify_all();
  }
}

std::optional<RgbdFrame> LatestFrame::Next() {
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

int LatestFrame::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

}  // namespace rgbd_pose
