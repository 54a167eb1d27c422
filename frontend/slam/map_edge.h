#pragma once

#include "core/geometry/motion.h"

namespace rgbd_pose {

// A motion that was measured between two keyframes: ids, or in a KeyframeGraph
// their numbers.
struct MapEdge : RelativePose {
  bool is_tracked = false;  // by the odometry, which is hardly ever wrong
  bool is_loop = false;     // links keyframes that were far apart in the graph
};

}  // namespace rgbd_pose
