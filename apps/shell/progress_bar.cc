#include "apps/shell/progress_bar.h"

#include <unistd.h>

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
  if (!visible_) return;
  const Clock::time_point now = Clock::now();
  if (done != total_ && now - last_drawn_ < kRedrawEvery) return;
  last_drawn_ = now;
  std::fprintf(stderr, "\r\033[K%s", Text(done).c_str());
  std::fflush(stderr);
}

std::string ProgressBar::Text(int done) const {
  if (total_ <= 0) return label_ + " " + std::to_string(done);
  const int filled = kBarWidth * done / total_;
  return label_ + " [" + std::string(filled, '#') +
         std::string(kBarWidth - filled, '.') +
         Format("] %d/%d, ", done, total_) + TimeLeft(done) + " left";
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
  const long long whole = std::llround(seconds);
  const long long minutes = whole / 60;
  if (whole < 60) return Format("%lld s", whole);
  if (minutes < 60) return Format("%lld min %02lld s", minutes, whole % 60);
  return Format("%lld h %02lld min", minutes / 60, minutes % 60);
}

}  // namespace rgbd_pose
