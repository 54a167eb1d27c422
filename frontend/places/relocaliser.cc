#include "frontend/places/relocaliser.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// What one search may do: describing an image takes about 8 ms, looking at a
// described one 3 ms.
constexpr size_t kMaxLooks = 5;
constexpr size_t kMaxDescriptions = 2;

}  // namespace

Place::Place(const Frame& keyframe, int id) : id_(id), frame_(keyframe) {
  frame_.gray = keyframe.gray.clone();
  frame_.depth = keyframe.depth.clone();
}

std::optional<Relocalisation> Relocaliser::Find(
    const Frame& frame, const std::vector<Place*>& places) {
  if (places.empty()) return std::nullopt;
  if (places.front()->id_ != latest_id_ || next_ >= places.size()) next_ = 1;
  latest_id_ = places.front()->id_;
  const PlaceFeatures current =
      DescribeKeyframe(frame, camera_, depth_options_);
  size_t descriptions = 0;
  for (size_t look = 0; look < std::min(kMaxLooks, places.size()); ++look) {
    // The latest, and those whose turn it is.
    const size_t at = look == 0 ? 0 : next_;
    Place& place = *places[at];
    if (!place.features_) {
      if (++descriptions > kMaxDescriptions) break;
      place.features_ = DescribeKeyframe(place.frame_, camera_, depth_options_);
      place.frame_ = Frame();
    }
    if (look > 0 && ++next_ >= places.size()) next_ = 1;
    if (const auto found = VerifyGeometrically(
            MatchPlaces(*place.features_, current, camera_))) {
      return Relocalisation{place.id_, found->cur_from_prev,
                            static_cast<int>(found->inliers.size())};
    }
  }
  return std::nullopt;
}

std::optional<Relocalisation> Relocaliser::FindInMap(
    const Frame& frame, const PlaceDatabase& index,
    const std::function<const PlaceFeatures&(int)>& features_of) const {
  const PlaceFeatures current =
      DescribeKeyframe(frame, camera_, depth_options_);
  std::optional<Relocalisation> best;
  for (const PlaceCandidate& candidate :
       index.Query(current.described.descriptors, kMaxLooks)) {
    const auto found = VerifyGeometrically(
        MatchPlaces(features_of(candidate.keyframe), current, camera_));
    const int inliers =
        found.has_value() ? static_cast<int>(found->inliers.size()) : 0;
    if (inliers <= (best.has_value() ? best->inliers : 0)) continue;
    best = Relocalisation{candidate.keyframe, found->cur_from_prev, inliers};
  }
  return best;
}

}  // namespace rgbd_pose
