#pragma once

#include <string>
#include <vector>

#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// frames.csv: a header and one row an input frame.
std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames);

// edges.csv: a header and one row an edge of the frames, frames numbered by the
// rows of frames.csv. cur_from_ref as translation (m) and quaternion, then the
// upper triangle of its covariance, row by row (see MotionEstimate).
std::string FormatEdgesCsv(const std::vector<TrackedFrame>& frames);

}  // namespace rgbd_pose
