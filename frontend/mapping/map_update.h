#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/frame/view_overlap.h"
#include "frontend/places/keyframe.h"

namespace rgbd_pose {

// Where a keyframe is.
struct KeyframePlace {
  Rigid3d map_from_cam;  // as now known
  int segment = 0;       // whose world `map` is
};

// Two keyframes that a measured motion joins, by id.
struct MapLink {
  int ref = 0;           // the earlier one
  int cur = 0;           // the later one
  bool is_loop = false;  // joins what was far apart
};

// What became of the map.
struct MapUpdate {
  std::map<int, KeyframePlace> moved;  // by id, since the last update
  std::vector<MapLink> links;          // new, those by tracking among them
  int pairs = 0;                       // that were added
  int loops = 0;                       // of these
  int joined = 0;                      // segments that became one
  std::string error;  // why poses were not solved for; empty: they were
  double ms = 0.0;    // of work

  // An old keyframe that the view has come back to.
  std::optional<Keyframe> returned_to;
};

// A keyframe of a Mapper, packed; of those that were removed neither images nor
// what was made of them. Its pose and segment: see KeyframeGraph.
struct MappedKeyframe : Keyframe {
  std::optional<KeyframePlace> published;  // as the last MapUpdate had it
  ViewOverlap samples;                     // what it sees, to compare views by
};

}  // namespace rgbd_pose
