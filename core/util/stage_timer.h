#pragma once

#include <chrono>

namespace rgbd_pose {

// Adds the lifetime of this object (ms) to a sum.
class StageTimer {
 public:
  explicit StageTimer(double* sum_ms) : sum_ms_(sum_ms) {}
  ~StageTimer() {
    *sum_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_)
                    .count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;

  double* sum_ms_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace rgbd_pose
