#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/geometry/rigid3.h"
#include "frontend/places/keyframe.h"

namespace rgbd_pose {

// Where a keyframe is.
struct KeyframePlace {
  Rigid3d map_from_cam;  // as now known
  int segment = 0;       // whose world `map` is
};

// What became of the map.
struct MapUpdate {
  std::map<int, KeyframePlace> moved;  // by id, since the last update
  int pairs = 0;                       // that were added
  int loops = 0;                       // of these
  int joined = 0;                      // segments that became one
  std::string error;  // why poses were not solved for; empty: they were
  double ms = 0.0;    // of work

  // An old keyframe that the view has come back to.
  std::optional<Keyframe> returned_to;
};

}  // namespace rgbd_pose
