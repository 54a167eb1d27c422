#include "frontend/sources/image_pairing.h"

#include <iterator>
#include <utility>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// Whether the images that wait take too much time or memory.
bool IsFull(const std::set<StampedImage>& images) {
  if (images.empty()) return false;
  size_t bytes = 0;
  for (const StampedImage& image : images) {
    bytes += image.message == nullptr ? 0 : image.message->size();
  }
  return bytes > ImagePairing::kMaxBytes ||
         images.rbegin()->timestamp - images.begin()->timestamp >
             ImagePairing::kMaxSeconds;
}

}  // namespace

std::string SameStampRemark(const std::string& recording, int images) {
  return recording + ": " + std::to_string(images) +
         (images == 1 ? " image has" : " images have") +
         " the same time stamp as another and " + (images == 1 ? "is" : "are") +
         " left out; are these the times when the images were taken?";
}

std::string IntervalRemark(const std::string& recording,
                           const std::vector<double>& timestamps) {
  // A camera's milliseconds are 11 s or more, read as seconds.
  constexpr double kLongInterval = 10.0;  // s
  std::vector<double> intervals;
  for (size_t i = 1; i < timestamps.size(); ++i) {
    intervals.push_back(timestamps[i] - timestamps[i - 1]);
  }
  if (intervals.empty()) return "";
  const double usual = Median(intervals);
  if (usual <= kLongInterval) return "";
  return recording +
         Format(
             ": frames are %.4g s apart; are their time stamps milli- or "
             "microseconds? They must be in seconds",
             usual);
}

bool ImagePairing::AddColor(StampedImage image) {
  if (image.timestamp < last_color_) return false;
  const bool is_new =
      image.timestamp > last_color_ && colors_.insert(std::move(image)).second;
  if (!is_new) ++same_stamp_;
  return true;
}

void ImagePairing::AddDepth(StampedImage image) {
  if (image.timestamp < last_color_ - max_difference_) {
    ++late_;
    return;
  }
  if (!depths_.insert(std::move(image)).second) ++same_stamp_;
  // Without colour images for long, the oldest depth images are left out.
  while (colors_.empty() && IsFull(depths_)) depths_.erase(depths_.begin());
}

std::optional<PairedImages<StampedImage>> ImagePairing::Take() {
  // As long as the depth image of the first colour image is certain.
  while (!colors_.empty() &&
         (is_finished_ || IsFull(colors_) || IsFull(depths_) ||
          (colors_.size() > kWindow && depths_.size() > kWindow))) {
    const std::vector<IndexPair> pairs =
        Associate(TimesOf(colors_), TimesOf(depths_), max_difference_);
    PairedImages<StampedImage> pair;
    pair.color = colors_.extract(colors_.begin()).value();
    last_color_ = pair.color.timestamp;
    const bool is_paired = !pairs.empty() && pairs.front().first == 0;
    if (is_paired) {
      const auto depth = std::next(depths_.begin(), pairs.front().second);
      pair.depth = depths_.extract(depth).value();
    } else {
      ++unmatched_color_;
    }
    // These depth images are too old for all later colour images.
    depths_.erase(depths_.begin(),
                  depths_.lower_bound({last_color_ - max_difference_, {}}));
    if (is_paired) return pair;
  }
  return std::nullopt;
}

PairedImages<StreamImage> ApproximateTimeSync::Next(
    const std::string& name, const std::function<StreamImage()>& read) {
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
    throw InputError(Format(
        "%s: sent %s images for %.3g s, but no colour and depth images within "
        "%.3g s of each other; does the camera send both?",
        name.c_str(), color.has_value() ? "colour" : "depth",
        std::chrono::duration<double>(patience_).count(),
        max_time_difference_));
  }
}

}  // namespace rgbd_pose
