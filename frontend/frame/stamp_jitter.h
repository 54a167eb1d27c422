#pragma once

#include <cstddef>
#include <vector>

namespace rgbd_pose {

// How much the stamps of depth images scatter against those of colour images.
// Two cameras of one device run evenly, each at its own rate, so the delay of
// depth changes evenly, too, but for jumps by a whole frame. What its second
// differences leave are errors of stamps, such as those of a host that stamps
// images when they arrive over USB.
class StampJitter {
 public:
  // The next frame: its delay (see Frame::depth_delay) and the time since the
  // frame before, s.
  void Add(double depth_delay, double interval);

  // Standard deviation of the errors of the delays, s, over the last second or
  // so; 0 as long as it is not known.
  double sigma() const;

 private:
  // The latest delays and what is left of their second differences, s.
  double delays_[2] = {0.0, 0.0};
  size_t num_delays_ = 0;
  std::vector<double> left_;
  size_t next_ = 0;  // to be replaced in left_
};

}  // namespace rgbd_pose
