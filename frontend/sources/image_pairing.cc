#include "frontend/sources/image_pairing.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {

std::string SameStampRemark(const std::string& recording, int images) {
  return recording + ": " + std::to_string(images) +
         (images == 1 ? " image has" : " images have") +
         " the same time stamp as another and " + (images == 1 ? "is" : "are") +
         " left out; are these the times when the images were taken?";
}

bool ImagePairing::Waiting::Insert(StampedImage image) {
  const auto place = std::lower_bound(
      images.begin(), images.end(), image.timestamp,
      [](const StampedImage& a, double stamp) { return a.timestamp < stamp; });
  if (place != images.end() && place->timestamp == image.timestamp) {
    return false;
  }
  if (image.message != nullptr) bytes += image.message->size();
  images.insert(place, std::move(image));
  return true;
}

StampedImage ImagePairing::Waiting::Remove(size_t index) {
  const auto place = images.begin() + static_cast<std::ptrdiff_t>(index);
  StampedImage image = std::move(*place);
  if (image.message != nullptr) bytes -= image.message->size();
  images.erase(place);
  return image;
}

bool ImagePairing::Waiting::IsFull() const {
  return !images.empty() &&
         (bytes > kMaxBytes ||
          images.back().timestamp - images.front().timestamp > kMaxSeconds);
}

bool ImagePairing::AddColor(StampedImage image) {
  if (last_color_.has_value() && image.timestamp <= *last_color_) {
    if (image.timestamp < *last_color_) return false;
    ++same_stamp_;
    return true;
  }
  if (!colors_.Insert(std::move(image))) ++same_stamp_;
  return true;
}

void ImagePairing::AddDepth(StampedImage image) {
  if (last_color_.has_value() &&
      image.timestamp < *last_color_ - max_difference_) {
    ++late_;
    return;
  }
  if (!depths_.Insert(std::move(image))) ++same_stamp_;
  // Without colour images for long, the oldest depth images are left out.
  while (colors_.images.empty() && depths_.IsFull()) depths_.Remove(0);
}

bool ImagePairing::CanDecide() const {
  if (colors_.images.empty()) return false;
  return is_finished_ || colors_.IsFull() || depths_.IsFull() ||
         (colors_.images.size() > kWindow && depths_.images.size() > kWindow);
}

std::optional<StampedPair> ImagePairing::Take() {
  while (CanDecide()) {
    const std::vector<IndexPair> pairs = Associate(
        TimesOf(colors_.images), TimesOf(depths_.images), max_difference_);
    StampedPair pair;
    pair.color = colors_.Remove(0);
    last_color_ = pair.color.timestamp;
    const bool is_paired = !pairs.empty() && pairs.front().first == 0;
    if (is_paired) {
      pair.depth = depths_.Remove(pairs.front().second);
    } else {
      ++unmatched_color_;
    }
    // These depth images are too old for all later colour images.
    while (!depths_.images.empty() &&
           depths_.images.front().timestamp < *last_color_ - max_difference_) {
      depths_.Remove(0);
    }
    if (is_paired) return pair;
  }
  return std::nullopt;
}

StreamPair ApproximateTimeSync::Next(const std::string& name,
                                     const std::function<StreamImage()>& read) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point began = Clock::now();
  std::optional<StreamImage> color;
  std::optional<StreamImage> depth;
  while (true) {
    StreamImage image = read();
    if (image.is_color && color.has_value()) ++unmatched_color_;
    (image.is_color ? color : depth) = std::move(image);
    if (color.has_value() && depth.has_value()) {
      const double delay = depth->stamp - color->stamp;
      if (delay > max_time_difference_) {
        ++unmatched_color_;
        color.reset();
      } else if (delay < -max_time_difference_ ||
                 color->stamp <= last_stamp_) {  // the camera restarted
        depth.reset();
      } else {
        last_stamp_ = color->stamp;
        return {std::move(*color), std::move(*depth)};
      }
    }
    if (Clock::now() - began < patience_) continue;
    const double seconds = std::chrono::duration<double>(patience_).count();
    throw InputError(Format(
        "%s: sent %s images for %.3g s, but no colour and depth images within "
        "%.3g s of each other; does the camera send both?",
        name.c_str(), color.has_value() ? "colour" : "depth", seconds,
        max_time_difference_));
  }
}

}  // namespace rgbd_pose
