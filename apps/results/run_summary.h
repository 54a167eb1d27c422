#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// What a run comes to, as metrics.json has it. Matches are of the frames that
// were matched against a reference, times of those in which something took
// place. `wall_seconds`: of the whole program, up to the last frame.
nlohmann::json Summarise(const std::vector<TrackedFrame>& frames, int threads,
                         double wall_seconds);

// As the program prints it: lines of a title and figures.
std::string FormatSummary(const nlohmann::json& summary);

}  // namespace rgbd_pose
