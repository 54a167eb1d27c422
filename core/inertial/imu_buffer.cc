#include "core/inertial/imu_buffer.h"

#include <algorithm>
#include <cmath>

#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Stamps are compared at this precision in messages.
std::string Seconds(double stamp) { return Format("%.6f s", stamp); }

ImuSample Interpolated(const ImuSample& a, const ImuSample& b, double stamp) {
  const double part = (stamp - a.stamp) / (b.stamp - a.stamp);
  return {stamp, a.gyro + part * (b.gyro - a.gyro),
          a.accel + part * (b.accel - a.accel)};
}

}  // namespace

std::string ImuNoise::Check() const {
  for (const double value :
       {gyro_density, accel_density, gyro_walk, accel_walk}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      return Format(
          "densities and random walks of an inertial sensor must be above 0, "
          "not %g",
          value);
    }
  }
  return "";
}

ImuBuffer::ImuBuffer(double max_gap) : max_gap_(max_gap) {
  if (!(max_gap > 0.0)) {
    throw InputError(Format(
        "the longest gap between inertial samples must be above 0 s, not %g",
        max_gap));
  }
}

void ImuBuffer::Add(const ImuSample& sample) {
  if (!std::isfinite(sample.stamp)) {
    throw InputError("the stamp of an inertial sample is not a finite number");
  }
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    throw InputError("the inertial sample at " + Seconds(sample.stamp) +
                     " is not finite");
  }
  if (!samples_.empty() && !(sample.stamp > samples_.back().stamp)) {
    throw InputError("the inertial sample at " + Seconds(sample.stamp) +
                     " is not later than the one before, at " +
                     Seconds(samples_.back().stamp));
  }
  samples_.push_back(sample);
}

void ImuBuffer::ForgetBefore(double stamp) {
  const auto later = std::upper_bound(
      samples_.begin(), samples_.end(), stamp,
      [](double time, const ImuSample& sample) { return time < sample.stamp; });
  if (later != samples_.begin()) samples_.erase(samples_.begin(), later - 1);
}

bool ImuBuffer::Covers(double from, double to) const {
  return from < to && !samples_.empty() && samples_.front().stamp <= from &&
         to <= samples_.back().stamp && Find(from, to).gap == nullptr;
}

ImuBuffer::Interval ImuBuffer::Find(double from, double to) const {
  Interval found;
  found.first = &*std::upper_bound(samples_.begin(), samples_.end(), from,
                                   [](double time, const ImuSample& sample) {
                                     return time < sample.stamp;
                                   }) -
                1;
  found.last = &*std::lower_bound(
      samples_.begin(), samples_.end(), to,
      [](const ImuSample& sample, double time) { return sample.stamp < time; });
  for (const ImuSample* sample = found.first; sample != found.last; ++sample) {
    if (sample[1].stamp - sample->stamp > max_gap_) {
      found.gap = sample;
      break;
    }
  }
  return found;
}

std::vector<ImuSample> ImuBuffer::Between(double from, double to) const {
  if (!(from < to)) {
    throw InputError("an inertial interval from " + Seconds(from) + " to " +
                     Seconds(to) + " has no length");
  }
  if (samples_.empty()) throw InputError("there are no inertial samples");
  if (!(samples_.front().stamp <= from) || !(to <= samples_.back().stamp)) {
    throw InputError("inertial samples from " +
                     Seconds(samples_.front().stamp) + " to " +
                     Seconds(samples_.back().stamp) + " do not cover " +
                     Seconds(from) + " to " + Seconds(to));
  }
  const auto [first, last, gap] = Find(from, to);
  if (gap != nullptr) {
    throw InputError("no inertial sample for " +
                     Format("%.3f s", gap[1].stamp - gap->stamp) + " after " +
                     Seconds(gap->stamp) +
                     Format(", the longest gap allowed is %g s", max_gap_));
  }
  std::vector<ImuSample> result;
  result.reserve(last - first + 1);
  result.push_back(Interpolated(*first, first[1], from));
  result.insert(result.end(), first + 1, last);
  result.push_back(Interpolated(last[-1], *last, to));
  return result;
}

}  // namespace rgbd_pose
