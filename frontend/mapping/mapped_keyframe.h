#pragma once

#include <optional>

#include "frontend/frame/view_overlap.h"
#include "frontend/map/stored_images.h"
#include "frontend/mapping/map_update.h"
#include "frontend/places/place_features.h"

namespace rgbd_pose {

// What a Mapper keeps of a keyframe; of those that were removed neither images
// nor what was made of them.
struct MappedKeyframe {
  int id = 0;                              // as in NewKeyframe
  std::optional<KeyframePlace> published;  // as the last MapUpdate had it

  StoredImages images;     // to track against
  ViewOverlap samples;     // what it sees, to compare views by
  PlaceFeatures features;  // what it looks like
};

}  // namespace rgbd_pose
