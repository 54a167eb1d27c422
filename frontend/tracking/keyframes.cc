#include "frontend/tracking/keyframes.h"

#include <utility>

#include "frontend/tracking/seen_at.h"

namespace rgbd_pose {
namespace {

// How the features of a keyframe appear to another camera.
struct Overlap {
  double share = 0.0;    // in view
  double flow_px = 0.0;  // mean distance to where they were
};

Overlap OverlapOf(const Camera& camera, const FeatureSet& features,
                  const Rigid3d& cur_from_keyframe) {
  Overlap overlap;
  int seen = 0;
  for (const Observation& o : features.observations) {
    // Lens distortion does not matter here.
    const auto pixel = SeenAt(camera, cur_from_keyframe, o);
    if (!pixel.has_value() || !camera.Contains(*pixel)) continue;
    ++seen;
    overlap.flow_px += (*pixel - Eigen::Vector2d(o.u, o.v)).norm();
  }
  if (seen == 0) return overlap;
  overlap.share = static_cast<double>(seen) / features.observations.size();
  overlap.flow_px /= seen;
  return overlap;
}

}  // namespace

Keyframe* Keyframes::Add(Keyframe keyframe) {
  if (keyframes_.size() == kMaxKeyframes) keyframes_.erase(keyframes_.begin());
  keyframes_.push_back(std::make_unique<Keyframe>(std::move(keyframe)));
  return keyframes_.back().get();
}

Keyframe* Keyframes::Find(int index) const {
  for (const auto& keyframe : keyframes_) {
    if (keyframe->index == index) return keyframe.get();
  }
  return nullptr;
}

Keyframe* Keyframes::FindNearest(const Rigid3d& world_from_cam, int segment,
                                 double min_share, double max_flow_px,
                                 const Keyframe* except) const {
  Keyframe* nearest = nullptr;
  for (const auto& keyframe : keyframes_) {
    if (keyframe.get() == except || keyframe->segment != segment) continue;
    const Overlap overlap =
        OverlapOf(camera_, *keyframe->features,
                  world_from_cam.Inverse() * keyframe->world_from_cam);
    if (overlap.share < min_share || overlap.flow_px > max_flow_px) continue;
    max_flow_px = overlap.flow_px;
    nearest = keyframe.get();
  }
  return nearest;
}

}  // namespace rgbd_pose
