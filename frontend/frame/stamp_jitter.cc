#include "frontend/frame/stamp_jitter.h"

#include <cmath>

#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

constexpr size_t kMostFrames = 30;
constexpr size_t kLeastFrames = 5;

}  // namespace

void StampJitter::Add(double depth_delay, double interval) {
  if (num_delays_ >= 2 && interval > 0.0) {
    const double second = depth_delay - 2.0 * delays_[1] + delays_[0];
    const double left =
        std::abs(second - interval * std::round(second / interval));
    if (left_.size() < kMostFrames) {
      left_.push_back(left);
    } else {
      left_[next_] = left;
      next_ = (next_ + 1) % kMostFrames;
    }
  }
  delays_[0] = delays_[1];
  delays_[1] = depth_delay;
  ++num_delays_;
}

double StampJitter::sigma() const {
  if (left_.size() < kLeastFrames) return 0.0;
  std::vector<double> left = left_;
  // A second difference has 1 + 4 + 1 times the variance of a delay.
  return kSigmaOfMedian * UpperMedian(&left) / std::sqrt(6.0);
}

}  // namespace rgbd_pose
