#pragma once

#include <deque>
#include <memory>
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

// Pairs a stream of colour images with one of depth images by nearest time, as
// Associate does for lists that are known as a whole. Keeps a few images of
// each: as many may be out of order, and so much does it look ahead.
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

  // How many images of a stream are looked at together.
  static constexpr int kWindow = 8;
  // Images of one stream that wait for those of the other, at most.
  static constexpr int kMaxWaiting = 3 * kWindow;

 private:
  // Whether it is known which depth image belongs to the first colour image.
  bool CanDecide() const;

  const double max_difference_;
  std::deque<StampedImage> colors_;  // in order of time
  std::deque<StampedImage> depths_;
  std::optional<double> last_color_;  // stamp of the last one that went by
  bool is_finished_ = false;
  int unmatched_color_ = 0;
};

}  // namespace rgbd_pose
