#include "apps/shell/progress_bar.h"

#include <unistd.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/util/format.h"

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
  const int filled = kBarWidth * done / total_;
  const std::string bar =
      std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %d/%d, %s left", label_.c_str(),
               bar.c_str(), done, total_, TimeLeft(done).c_str());
  std::fflush(stderr);
}

void ProgressBar::PrintLine(const std::string& line) {
  std::fprintf(stderr, "%s%s\n", visible_ ? "\r\033[K" : "", line.c_str());
}

std::string ProgressBar::TimeLeft(int done) const {
  if (done <= 0) return "?";
  const std::chrono::duration<double> elapsed = Clock::now() - start_;
  return FormatDuration(elapsed.count() * (total_ - done) / done);
}

std::string FormatDuration(double seconds) {
  constexpr int64_t kMinute = 60;
  constexpr int64_t kHour = 60 * kMinute;
  const int64_t whole = std::llround(seconds);
  if (whole < kMinute) return Format("%" PRId64 " s", whole);
  if (whole < kHour) {
    return Format("%" PRId64 " min %02" PRId64 " s", whole / kMinute,
                  whole % kMinute);
  }
  return Format("%" PRId64 " h %02" PRId64 " min", whole / kHour,
                whole % kHour / kMinute);
}

}  // namespace rgbd_pose
