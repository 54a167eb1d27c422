#pragma once

#include <filesystem>
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

// The edges of the edges.csv of a run, and its frames with times, statuses and
// edges. Throw InputError for a folder without such files or whose files do
// not fit each other.
std::vector<RelativePose> ReadEdges(const std::filesystem::path& folder);
std::vector<TrackedFrame> ReadFrames(const std::filesystem::path& folder);

}  // namespace rgbd_pose
