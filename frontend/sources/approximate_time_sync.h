#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

namespace rgbd_pose {

// One image of a camera that runs.
struct StreamImage {
  bool is_color = false;  // otherwise depth
  double stamp = 0.0;     // s
  cv::Mat pixels;         // its own
};

// Images of one moment.
struct StreamPair {
  StreamImage color;
  StreamImage depth;
};

// Pairs colour and depth images of a camera that runs, which come in whatever
// order, by their stamps.
class ApproximateTimeSync {
 public:
  // Images of a pair are at most `max_time_difference` (s) apart; after
  // `patience` without a pair, the camera is taken for broken.
  ApproximateTimeSync(double max_time_difference,
                      std::chrono::milliseconds patience)
      : max_time_difference_(max_time_difference), patience_(patience) {}

  // The next pair of what `read`, which waits for an image, gives. Pairs come
  // in order of time. Throws what `read` does, and InputError, with `name` (of
  // the camera) before it, if images come but no pair.
  StreamPair Next(const std::string& name,
                  const std::function<StreamImage()>& read);

  // Colour images so far without depth. May be asked for by another thread.
  int unmatched_color() const { return unmatched_color_; }

 private:
  const double max_time_difference_;
  const std::chrono::milliseconds patience_;
  std::atomic<int> unmatched_color_ = 0;
  double last_stamp_ = -1.0;
};

}  // namespace rgbd_pose
