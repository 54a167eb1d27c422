#include "frontend/tracking/keyframes.h"

#include <utility>

namespace rgbd_pose {
Keyframe* Keyframes::Add(Keyframe keyframe) {
  if (keyframes_.size() == kMaxKeyframes) keyframes_.erase(keyframes_.begin());
  keyframes_.push_back(std::make_unique<Keyframe>(std::move(keyframe)));
  return keyframes_.back().get();
}

Keyframe* Keyframes::Find(int id) const {
  for (const auto& keyframe : keyframes_) {
    if (keyframe->id == id) return keyframe.get();
  }
  return nullptr;
}

std::vector<Place*> Keyframes::Places() const {
  std::vector<Place*> places;
  for (const auto& keyframe : keyframes_) {
    places.insert(places.begin(), keyframe->place.get());
  }
  return places;
}

Keyframe* Keyframes::FindNearest(const Rigid3d& world_from_cam, int segment,
                                 double min_share, double max_flow_px,
                                 const Keyframe* except) const {
  Keyframe* nearest = nullptr;
  for (const auto& keyframe : keyframes_) {
    if (keyframe.get() == except || keyframe->segment != segment) continue;
    const Overlap overlap = keyframe->reference->SeenFrom(
        world_from_cam.Inverse() * keyframe->world_from_cam);
    if (overlap.share < min_share || overlap.flow_px > max_flow_px) continue;
    max_flow_px = overlap.flow_px;
    nearest = keyframe.get();
  }
  return nearest;
}

}  // namespace rgbd_pose
