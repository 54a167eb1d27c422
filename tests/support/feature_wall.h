#pragma once

#include <memory>
#include <utility>

#include "frontend/tracking/feature_tracker.h"

namespace rgbd_pose {

inline const Camera kWallCamera = {640, 480, 525, 525, 319.5, 239.5, 0, 0, 0};

// 15 x 11 features on a wall at 2 m.
inline ReferenceFeatures FeatureWall() {
  auto features = std::make_unique<FeatureSet>();
  for (int v = 40; v < 480; v += 40) {
    for (int u = 40; u < 640; u += 40) {
      features->observations.push_back({1.0 * u, 1.0 * v, 2.0, 0.5, 0.01});
    }
  }
  const FeatureValidation validation(features->observations.size());
  return ReferenceFeatures(kWallCamera, std::move(features), validation);
}

}  // namespace rgbd_pose
