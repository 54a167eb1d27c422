#pragma once

#include <string>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A warning of one line if the median depth of a frame is implausible for an
// RGB-D camera (below 0.2 m or above 20 m), as caused by a wrong depth scale.
// Empty if it is plausible or if the frame has no depth. Small errors are not
// detected: a scale that is wrong by a factor of 5 still gives plausible rooms.
std::string DepthScaleWarning(const Frame& frame);

}  // namespace rgbd_pose
