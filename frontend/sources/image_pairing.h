#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace rgbd_pose {

// A colour image and its depth image.
template <typename Image>
struct PairedImages {
  Image color;  // its stamp becomes the frame's
  Image depth;  // near it in time
};

// An image of a recording, ordered by time.
struct StampedImage {
  double timestamp = 0.0;                      // s
  std::shared_ptr<const std::string> message;  // serialised

  bool operator<(const StampedImage& other) const {
    return timestamp < other.timestamp;
  }
};

// A remark for users: images were left out because of duplicate stamps.
std::string SameStampRemark(const std::string& recording, int images);

// A remark for users if frames are so far apart that their time stamps (s) are
// probably in another unit; empty otherwise.
std::string IntervalRemark(const std::string& recording,
                           const std::vector<double>& timestamps);

// Pairs a stream of colour images with a stream of depth images by nearest
// time, as Associate does for complete lists. Images may be out of order within
// a window of kWindow images of each stream. If one stream lags behind, up to
// kMaxSeconds or kMaxBytes of the other one are kept.
class ImagePairing {
 public:
  // `max_difference`: largest time between the two images of a pair, s.
  explicit ImagePairing(double max_difference)
      : max_difference_(max_difference) {}

  // Adds the next image of a stream. Images with a known stamp are left out,
  // and those that come after later ones were processed (AddColor: false).
  bool AddColor(StampedImage image);
  void AddDepth(StampedImage image);

  // To be called after the last image.
  void Finish() { is_finished_ = true; }

  // The next pair by time, once it is certain. Nothing: add more images; after
  // Finish: there are no more pairs.
  std::optional<PairedImages<StampedImage>> Take();

  // Colour images processed without finding a depth image.
  int unmatched_color() const { return unmatched_color_; }

  // Images left out because another one of their stream has the same stamp.
  int same_stamp() const { return same_stamp_; }

  // Depth images that came too late: later colour images were processed.
  int late() const { return late_; }

  // How many images of a stream are considered together.
  static constexpr int kWindow = 8;
  // Limits for one stream that waits for the other.
  static constexpr double kMaxSeconds = 30.0;
  static constexpr size_t kMaxBytes = size_t{256} << 20;

 private:
  const double max_difference_;
  std::set<StampedImage> colors_;  // that wait for their counterparts
  std::set<StampedImage> depths_;
  // Stamp of the last colour image processed.
  double last_color_ = -INFINITY;
  bool is_finished_ = false;
  int unmatched_color_ = 0;
  int same_stamp_ = 0;
  int late_ = 0;
};

// One image of a live camera.
struct StreamImage {
  bool is_color = false;  // otherwise depth
  double stamp = 0.0;     // s
  cv::Mat pixels;         // not shared
};

// Pairs the images of a live camera, which come in any order, by their stamps.
class ApproximateTimeSync {
 public:
  // Images of a pair are at most `max_time_difference` (s) apart. After
  // `patience` without a pair, the camera is considered broken.
  ApproximateTimeSync(double max_time_difference,
                      std::chrono::milliseconds patience)
      : max_time_difference_(max_time_difference), patience_(patience) {}

  // The next pair, in order of time. `read` waits for an image. Throws what it
  // throws, and InputError with `name` (of the camera) if no pair comes.
  PairedImages<StreamImage> Next(const std::string& name,
                                 const std::function<StreamImage()>& read);

  // Colour images without depth so far. May be called from another thread.
  int unmatched_color() const { return unmatched_color_; }

 private:
  const double max_time_difference_;
  const std::chrono::milliseconds patience_;
  std::atomic<int> unmatched_color_ = 0;
  double last_stamp_ = -1.0;
};

}  // namespace rgbd_pose
