#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace rgbd_pose {

// An image that waits for its other half.
struct StampedImage {
  double stamp = 0.0;                          // s
  std::shared_ptr<const std::string> message;  // its bytes
};

// A colour image and its depth image.
struct StampedPair {
  StampedImage color;  // its stamp is that of the frame
  StampedImage depth;  // near it in time
};

// A line for users on images that have another one's time stamp.
std::string SameStampRemark(const std::string& recording, int images);

// Pairs a stream of colour images with one of depth images by nearest time, as
// Associate does for lists that are known as a whole. Keeps a few images of
// each: as many may be out of order, and so much does it look ahead. Where one
// stream lags behind the other, it waits for kMaxSeconds or kMaxBytes of that.
class ImagePairing {
 public:
  // `max_difference`: s between the two images of a pair, at most.
  explicit ImagePairing(double max_difference)
      : max_difference_(max_difference) {}

  // The next image of a stream; one whose stamp was there already is left out.
  // Returns false for a colour image that comes too late: a later one has gone
  // by already. Such a depth image is left out.
  bool AddColor(StampedImage image);
  void AddDepth(StampedImage image);

  // No more images will come.
  void Finish() { is_finished_ = true; }

  // The next pair by time, once enough is known; nothing: add more, or all is
  // done if it is finished.
  std::optional<StampedPair> Take();

  // Colour images that have gone by without a depth image.
  int unmatched_color() const { return unmatched_color_; }

  // Images left out since another of their stream has the same stamp.
  int same_stamp() const { return same_stamp_; }

  // Images that came after those of their time had gone by.
  int late() const { return late_; }

  // How many images of a stream are looked at together.
  static constexpr int kWindow = 8;
  // Of one stream that wait for the other, at most: by their stamps (s), and
  // by the memory they take.
  static constexpr double kMaxSeconds = 30.0;
  static constexpr size_t kMaxBytes = size_t{256} << 20;

 private:
  // Whether it is known which depth image belongs to the first colour image.
  bool CanDecide() const;

  // Images of a stream, in order of time.
  struct Waiting {
    std::deque<StampedImage> images;
    size_t bytes = 0;

    // False if there is one of that stamp.
    bool Insert(StampedImage image);
    StampedImage Remove(size_t index);
    bool IsFull() const;
    bool empty() const { return images.empty(); }
    size_t size() const { return images.size(); }
  };

  const double max_difference_;
  Waiting colors_;
  Waiting depths_;
  std::optional<double> last_color_;  // stamp of the last one that went by
  bool is_finished_ = false;
  int unmatched_color_ = 0;
  int same_stamp_ = 0;
  int late_ = 0;
};

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
