#pragma once

#include <chrono>
#include <string>

namespace rgbd_pose {

// A progress bar on stderr, if this is a terminal. It is erased on destruction.
// If the total is unknown (0), it is only a number.
class ProgressBar {
 public:
  ProgressBar(std::string label, int total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Reports that `done` items are finished. Redraws at most ten times a second.
  void Update(int done);

  // Prints a line on stderr, terminal or not; the bar is redrawn below it.
  void PrintLine(const std::string& line);

  // Whether the bar is drawn.
  bool visible() const { return visible_; }

  // What is drawn: "tracking [###...] 50/100, 12 s left", or "tracking 50".
  std::string Text(int done) const;

  // The estimated remaining time: "12 s", "3 h 05 min".
  std::string TimeLeft(int done) const;

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  int total_;
  bool visible_;
  Clock::time_point start_;
  Clock::time_point last_drawn_;
};

// Formats a duration for people: "12 s", "4 min 08 s", "3 h 05 min".
std::string FormatDuration(double seconds);

}  // namespace rgbd_pose
