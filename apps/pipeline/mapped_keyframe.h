#pragma once

#include <optional>

#include "apps/pipeline/map_update.h"
#include "frontend/image/view_samples.h"
#include "frontend/map/stored_images.h"
#include "frontend/places/place_features.h"

namespace rgbd_pose {

// What a Mapper keeps of a keyframe; of those that made way neither images nor
// what was made of them.
struct MappedKeyframe {
  int id = 0;                         // as in NewKeyframe
  std::optional<KeyframePlace> told;  // as the last MapUpdate had it

  StoredImages images;     // to track against
  ViewSamples samples;     // what it sees, to compare views by
  PlaceFeatures features;  // what it looks like
};

}  // namespace rgbd_pose
