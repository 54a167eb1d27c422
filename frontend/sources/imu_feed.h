#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/inertial/imu_sample.h"

namespace rgbd_pose {

// Hands the samples of an inertial sensor out with the frames of its camera.
class ImuFeed {
 public:
  // How far the samples of a frame reach beyond its stamp, s: up to 0.05 s for
  // the rows of a rolling shutter, and a delay that nobody has told.
  static constexpr double kReach = 0.15;

  // `delay_s`: see ImuCalibration.
  explicit ImuFeed(double delay_s = 0.0) : delay_s_(delay_s) {}

  // Adds the next sample. One that is not finite or not later than the one
  // before, as some drivers send, is left out and counted.
  void Add(const ImuSample& sample);

  // Whether the samples so far reach beyond a frame's stamp by kReach.
  bool Covers(double frame_stamp) const;

  // Removes and returns the samples up to the first one that is kReach beyond a
  // frame's stamp, so that values there can be interpolated. None if one that
  // far was taken already.
  std::vector<ImuSample> Take(double frame_stamp);

  // A remark for users on samples that were left out; empty if there are none.
  std::string Remark(const std::string& name) const;

 private:
  // The end of what a frame needs, by the sensor's clock.
  double EndOf(double frame_stamp) const {
    return frame_stamp + delay_s_ + kReach;
  }

  double delay_s_;
  std::optional<double> last_;  // the stamp of the last sample, s
  std::optional<double> last_taken_;
  int left_out_ = 0;
  std::deque<ImuSample> samples_;  // not taken yet
};

}  // namespace rgbd_pose
