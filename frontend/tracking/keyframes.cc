#include "frontend/tracking/keyframes.h"

#include <algorithm>
#include <utility>

namespace rgbd_pose {

OdometryKeyframe* Keyframes::Add(OdometryKeyframe keyframe,
                                 const OdometryKeyframe* in_use) {
  if (keyframes_.size() == kMaxKeyframes) {
    keyframes_.erase(keyframes_.begin() +
                     (keyframes_.front().get() == in_use ? 1 : 0));
  }
  keyframes_.push_back(std::make_unique<OdometryKeyframe>(std::move(keyframe)));
  return keyframes_.back().get();
}

void Keyframes::Renew(const OdometryKeyframe* keyframe) {
  std::stable_partition(
      keyframes_.begin(), keyframes_.end(),
      [=](const auto& kept) { return kept.get() != keyframe; });
}

OdometryKeyframe* Keyframes::Find(int id) const {
  for (const auto& keyframe : keyframes_) {
    if (keyframe->id == id) return keyframe.get();
  }
  return nullptr;
}

std::vector<Keyframe*> Keyframes::Before(int segment) const {
  std::vector<Keyframe*> before;
  for (const auto& keyframe : keyframes_) {
    if (keyframe->segment >= segment) continue;
    before.insert(before.begin(), keyframe.get());
  }
  return before;
}

OdometryKeyframe* Keyframes::FindNearest(const Rigid3d& world_from_cam,
                                         int segment, double min_share,
                                         double max_flow_px,
                                         const OdometryKeyframe* except) const {
  OdometryKeyframe* nearest = nullptr;
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
