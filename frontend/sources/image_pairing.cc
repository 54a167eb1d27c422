#include "frontend/sources/image_pairing.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/evaluation/association.h"

namespace rgbd_pose {
namespace {

void Insert(StampedImage image, std::deque<StampedImage>* images) {
  const auto place = std::lower_bound(
      images->begin(), images->end(), image.stamp,
      [](const StampedImage& a, double stamp) { return a.stamp < stamp; });
  if (place != images->end() && place->stamp == image.stamp) return;
  images->insert(place, std::move(image));
}

std::vector<double> StampsOf(const std::deque<StampedImage>& images) {
  std::vector<double> stamps;
  for (const StampedImage& image : images) stamps.push_back(image.stamp);
  return stamps;
}

}  // namespace

bool ImagePairing::AddColor(StampedImage image) {
  if (last_color_.has_value() && image.stamp <= *last_color_) {
    return image.stamp == *last_color_;
  }
  Insert(std::move(image), &colors_);
  return true;
}

void ImagePairing::AddDepth(StampedImage image) {
  if (last_color_.has_value() && image.stamp < *last_color_ - max_difference_) {
    return;
  }
  Insert(std::move(image), &depths_);
  // Nothing of colour for long: the oldest ones are left out.
  if (depths_.size() > kMaxWaiting && colors_.empty()) depths_.pop_front();
}

bool ImagePairing::CanDecide() const {
  if (colors_.empty()) return false;
  return is_finished_ || colors_.size() > kMaxWaiting ||
         depths_.size() > kMaxWaiting ||
         (colors_.size() > kWindow && depths_.size() > kWindow);
}

std::optional<StampedPair> ImagePairing::Take() {
  while (CanDecide()) {
    const std::vector<IndexPair> pairs =
        Associate(StampsOf(colors_), StampsOf(depths_), max_difference_);
    StampedPair pair;
    pair.color = std::move(colors_.front());
    colors_.pop_front();
    last_color_ = pair.color.stamp;
    const bool is_paired = !pairs.empty() && pairs.front().first == 0;
    if (is_paired) {
      const auto depth = depths_.begin() + pairs.front().second;
      pair.depth = std::move(*depth);
      depths_.erase(depth);
    } else {
      ++unmatched_color_;
    }
    // Too old for any colour image that is to come.
    while (!depths_.empty() &&
           depths_.front().stamp < *last_color_ - max_difference_) {
      depths_.pop_front();
    }
    if (is_paired) return pair;
  }
  return std::nullopt;
}

}  // namespace rgbd_pose
