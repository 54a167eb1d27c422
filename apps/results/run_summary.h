#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// Summarises a run for metrics.json. Match statistics include only frames that
// were matched against a reference; times include only frames in which the step
// took place. `wall_seconds` is the time of the whole program up to the last
// frame.
nlohmann::json Summarise(const std::vector<TrackedFrame>& frames, int threads,
                         double wall_seconds);

// Formats the summary for printing: lines with a title and figures.
std::string FormatSummary(const nlohmann::json& summary);

// For metrics.json: the jumps of the run, at most 20, largest first, and what
// tracked these frames. There, the motion to a frame differs from the mean of
// its neighbours by over 10 mm and over six times the median difference, which
// grows if the camera shakes. Frames next to a lost one or a gap are not
// checked.
nlohmann::json FindJumps(const std::vector<TrackedFrame>& frames);

// Describes the jumps in one line, or empty if there are none.
std::string FormatJumps(const nlohmann::json& jumps);

}  // namespace rgbd_pose
