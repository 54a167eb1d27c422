#pragma once

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The camera's velocity into its last frame. An acceleration would be known as
// well, but it doubles the noise, and poses feed back into what they are made
// of: with it a noisy sequence has oscillated until it was lost.
class RecentMotion {
 public:
  RecentMotion() = default;  // not known
  // The motion of an interval (s), in which it is at constant rates.
  RecentMotion(const Rigid3d& cur_from_prev, double interval)
      : cur_from_prev_(cur_from_prev), interval_(interval) {}

  // Whether anything is known.
  bool is_known() const { return interval_ > 0.0; }

  // later_from_earlier at two times so far apart (s; negative: earlier), near
  // to the interval.
  Rigid3d During(double seconds) const;

 private:
  Rigid3d cur_from_prev_;
  double interval_ = 0.0;  // 0: not known
};

}  // namespace rgbd_pose
