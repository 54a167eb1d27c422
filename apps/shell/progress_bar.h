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

  // Prints a line on stderr, terminal or not; the bar moves below it with the
  // next update.
  void PrintLine(const std::string& line);

  // Whether the bar is drawn at all.
  bool visible() const { return visible_; }

  // How long the rest will take, if it goes on like this: "12 s", "3 h 05 min".
  std::string TimeLeft(int done) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  int total_;
  bool visible_;
  Clock::time_point start_;
  Clock::time_point last_drawn_;
};

// A duration as people say it: "12 s", "4 min 08 s", "3 h 05 min".
std::string FormatDuration(double seconds);

}  // namespace rgbd_pose
