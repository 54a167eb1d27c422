#include "frontend/places/relocaliser.h"

#include <algorithm>
#include <memory>

namespace rgbd_pose {
namespace {

// Limits of one search: to describe an image takes 8 ms, to compare two 3 ms.
constexpr size_t kMaxLooks = 5;
constexpr size_t kMaxDescriptions = 2;

}  // namespace

const PlaceFeatures& Relocaliser::FeaturesOf(Keyframe* keyframe) const {
  if (keyframe->features == nullptr) {
    keyframe->features = std::make_shared<const PlaceFeatures>(
        DescribeKeyframe(keyframe->Unpacked(), images_));
  }
  return *keyframe->features;
}

std::optional<Relocalisation> Relocaliser::Find(
    const PreparedFrame& frame, const std::vector<Keyframe*>& keyframes) {
  const size_t count = keyframes.size();
  if (count == 0) return std::nullopt;
  if (keyframes.front()->id != latest_id_) {
    // One more keyframe since the last search shifts the others by one.
    const bool is_shifted = count > 1 && keyframes[1]->id == latest_id_;
    next_ = is_shifted ? next_ + 1 : 1;
  }
  if (next_ >= count) next_ = 1;
  latest_id_ = keyframes.front()->id;
  const PlaceFeatures current = DescribeKeyframe(frame, images_);
  size_t descriptions = 0;
  for (size_t look = 0; look < std::min(kMaxLooks, count); ++look) {
    // The latest keyframe, then those whose turn it is.
    const size_t at = look == 0 ? 0 : next_;
    Keyframe& keyframe = *keyframes[at];
    if (keyframe.features == nullptr && ++descriptions > kMaxDescriptions) {
      break;
    }
    if (look > 0 && ++next_ >= count) next_ = 1;
    if (const auto found = VerifyGeometrically(FeaturesOf(&keyframe), current,
                                               images_.camera)) {
      return Relocalisation{keyframe.id, found->cur_from_prev,
                            static_cast<int>(found->inliers.size())};
    }
  }
  return std::nullopt;
}

bool Relocaliser::FindIn(const PreparedFrame& frame, Keyframe* keyframe,
                         Rigid3d* cur_from_keyframe) const {
  const auto found = VerifyGeometrically(
      FeaturesOf(keyframe), DescribeKeyframe(frame, images_), images_.camera);
  if (!found.has_value()) return false;
  *cur_from_keyframe = found->cur_from_prev;
  return true;
}

std::optional<Relocalisation> Relocaliser::FindInMap(
    const PreparedFrame& frame, const PlaceDatabase& index,
    const std::function<const PlaceFeatures&(int)>& features_of) const {
  const PlaceFeatures current = DescribeKeyframe(frame, images_);
  std::optional<Relocalisation> best;
  for (const PlaceCandidate& candidate :
       index.Query(current.described.descriptors, kMaxLooks)) {
    const auto found = VerifyGeometrically(features_of(candidate.keyframe),
                                           current, images_.camera);
    const int inliers =
        found.has_value() ? static_cast<int>(found->inliers.size()) : 0;
    if (inliers <= (best.has_value() ? best->inliers : 0)) continue;
    best = Relocalisation{candidate.keyframe, found->cur_from_prev, inliers};
  }
  return best;
}

}  // namespace rgbd_pose
