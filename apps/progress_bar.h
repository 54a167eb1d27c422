#pragma once

#include <chrono>
#include <string>

namespace rgbd_pose {

// A progress bar with the time left, drawn on stderr only if that is a
// terminal. Removes itself when destroyed.
class ProgressBar {
 public:
  ProgressBar(std::string label, int total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Says that `done` of `total` items are ready; redraws at most ten times a
  // second.
  void Update(int done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  int total_;
  bool visible_;
  Clock::time_point start_;
  Clock::time_point last_drawn_;
};

}  // namespace rgbd_pose
