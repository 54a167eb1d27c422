#pragma once

#include <optional>

#include "frontend/frame/view_overlap.h"
#include "frontend/mapping/map_update.h"
#include "frontend/places/keyframe.h"

namespace rgbd_pose {

// A keyframe of a Mapper, packed; of those that were removed neither images nor
// what was made of them. Its pose and segment: see KeyframeGraph.
struct MappedKeyframe : Keyframe {
  std::optional<KeyframePlace> published;  // as the last MapUpdate had it
  ViewOverlap samples;                     // what it sees, to compare views by
};

}  // namespace rgbd_pose
