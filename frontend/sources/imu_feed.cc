#include "frontend/sources/imu_feed.h"

#include <algorithm>
#include <cmath>

#include "core/util/format.h"

namespace rgbd_pose {

void ImuFeed::Add(const ImuSample& sample) {
  const bool is_finite = std::isfinite(sample.stamp) &&
                         sample.gyro.allFinite() && sample.accel.allFinite();
  if (!is_finite || (last_.has_value() && !(sample.stamp > *last_))) {
    ++left_out_;
    return;
  }
  last_ = sample.stamp;
  samples_.push_back(sample);
}

bool ImuFeed::Covers(double frame_stamp) const {
  return last_.has_value() && *last_ >= EndOf(frame_stamp);
}

std::vector<ImuSample> ImuFeed::Take(double frame_stamp) {
  const double end = EndOf(frame_stamp);
  if (last_taken_.has_value() && *last_taken_ >= end) return {};
  auto last = std::find_if(
      samples_.begin(), samples_.end(),
      [end](const ImuSample& sample) { return sample.stamp >= end; });
  if (last != samples_.end()) ++last;
  std::vector<ImuSample> taken(samples_.begin(), last);
  samples_.erase(samples_.begin(), last);
  if (!taken.empty()) last_taken_ = taken.back().stamp;
  return taken;
}

std::string ImuFeed::Remark(const std::string& name) const {
  if (left_out_ == 0) return "";
  return name + Format(
                    ": left out %d inertial samples that are not finite or "
                    "not later than the one before",
                    left_out_);
}

}  // namespace rgbd_pose
