#pragma once

#include <vector>

#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// The samples of one inertial sensor, in the order of their stamps.
class ImuBuffer {
 public:
  // Intervals with a longer gap (s) between neighbouring samples are refused:
  // what happened in it was not measured. The sensors of cameras have 60 to
  // 400 samples per second.
  static constexpr double kMaxGap = 0.05;

  // Throws InputError unless 0 < max_gap.
  explicit ImuBuffer(double max_gap = kMaxGap);

  // Adds the next sample. Throws InputError, and leaves it out, if a number is
  // not finite or the stamp is not later than the one before.
  void Add(const ImuSample& sample);

  // Forgets what is older than the last sample up to `stamp`.
  void ForgetBefore(double stamp);

  // Whether Between has samples for an interval: they reach that far, and there
  // is no gap.
  bool Covers(double from, double to) const;

  // The samples from one time to a later one (s), interpolated linearly at both
  // ends: the first has the stamp `from`, the last `to`. Throws InputError if
  // the times are not in order, if the samples do not reach that far, or if
  // there is a gap.
  std::vector<ImuSample> Between(double from, double to) const;

  // All samples.
  const std::vector<ImuSample>& samples() const { return samples_; }

 private:
  // The last sample up to a time, and the first one from a later time on; the
  // sample between them that is followed by a gap, or null.
  struct Interval {
    const ImuSample* first = nullptr;
    const ImuSample* last = nullptr;
    const ImuSample* gap = nullptr;
  };
  Interval Find(double from, double to) const;

  double max_gap_;
  std::vector<ImuSample> samples_;
};

}  // namespace rgbd_pose
