#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/frame/view_overlap.h"
#include "frontend/places/keyframe.h"

namespace rgbd_pose {

// The pose of a keyframe in the map.
struct KeyframePlace {
  Rigid3d map_from_cam;  // current estimate
  int segment = 0;       // `map` is the world frame of this segment
};

// Two keyframes linked by a measured motion, by id.
struct MapLink {
  int ref = 0;           // the earlier one
  int cur = 0;           // the later one
  bool is_loop = false;  // links keyframes that were far apart in the graph
};

// Changes of the map.
struct MapUpdate {
  std::map<int, KeyframePlace> moved;  // by id, since the last update
  std::vector<MapLink> links;          // new ones, including tracked ones
  int pairs = 0;                       // number of pairs added
  int loops = 0;                       // number of these that are loops
  int joined = 0;                      // number of segments merged
  std::string error;  // why optimising the poses failed, or empty
  double ms = 0.0;    // computing time

  // An old keyframe to whose view the camera has returned.
  std::optional<Keyframe> returned_to;
};

// A keyframe of a Mapper with compressed images. Removed keyframes have neither
// images nor derived data. Pose and segment are in KeyframeGraph.
struct MappedKeyframe : Keyframe {
  std::optional<KeyframePlace> published;  // in the last MapUpdate
  ViewOverlap samples;                     // to compare views
};

}  // namespace rgbd_pose
