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

// A frame whose pose does not follow from those of its neighbours: its motion
// differs from the mean of the motions before and after it.
struct MotionJump {
  int frame = 0;             // place in the run
  double translation = 0.0;  // by how much it differs, m
};

// The largest of the run, at most 20, largest first: more than 10 mm, and more
// than six times what the median frame differs by, as a camera that is shaken
// has such motions without an error. Only where three motions follow each other
// without a lost frame or a gap in time.
std::vector<MotionJump> FindJumps(const std::vector<TrackedFrame>& frames);

// One line, or empty if there are none.
std::string FormatJumps(const std::vector<MotionJump>& jumps,
                        const std::vector<TrackedFrame>& frames);

// For metrics.json: with what each frame was tracked by.
nlohmann::json JumpsToJson(const std::vector<MotionJump>& jumps,
                           const std::vector<TrackedFrame>& frames);

}  // namespace rgbd_pose
