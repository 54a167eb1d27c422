#pragma once

#include <string>
#include <vector>

#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// frames.csv: a header and one row an input frame.
std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames);

}  // namespace rgbd_pose
