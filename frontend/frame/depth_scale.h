#pragma once

#include <string>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// One line if the median depth of a frame is implausible for an RGB-D camera
// (below 0.2 m or above 20 m), which a wrong depth scale causes. Empty if it is
// plausible or if the frame has no depth at all. It cannot see small errors: a
// scale that is wrong by a factor of 5 still gives plausible rooms.
std::string DepthScaleWarning(const Frame& frame);

}  // namespace rgbd_pose
