#include "apps/progress_bar.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace rgbd_pose {
namespace {

constexpr int kBarWidth = 30;
constexpr auto kRedrawEvery = std::chrono::milliseconds(100);

}  // namespace

ProgressBar::ProgressBar(std::string label, int total)
    : label_(std::move(label)),
      total_(total),
      visible_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()) {}

ProgressBar::~ProgressBar() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::Update(int done) {
  if (!visible_ || total_ <= 0) return;
  const Clock::time_point now = Clock::now();
  if (done < total_ && now - last_drawn_ < kRedrawEvery) return;
  last_drawn_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double left = done > 0 ? elapsed * (total_ - done) / done : 0.0;
  const int filled = kBarWidth * done / total_;
  const std::string bar =
      std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %d/%d, %.0f s left", label_.c_str(),
               bar.c_str(), done, total_, left);
  std::fflush(stderr);
}

}  // namespace rgbd_pose
