#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// Summarises a run for metrics.json. Match statistics include only frames that
// were matched against a reference; times include only frames in which the step
// took place. `wall_seconds`: time of the whole program up to the last frame.
nlohmann::json Summarise(const std::vector<TrackedFrame>& frames, int threads,
                         double wall_seconds);

// Formats the summary for printing: lines with a title and figures.
std::string FormatSummary(const nlohmann::json& summary);

// A frame whose pose is inconsistent with its neighbours: its motion differs
// from the mean of the motions before and after it.
struct MotionJump {
  int frame = 0;             // index in the run
  double translation = 0.0;  // size of the difference, m
};

// Returns the largest jumps of the run, at most 20, largest first. A jump is
// larger than 10 mm and than six times the median difference, because a shaken
// camera shows such differences without an error. Only frames within three
// consecutive motions without a lost frame or a time gap are checked.
std::vector<MotionJump> FindJumps(const std::vector<TrackedFrame>& frames);

// Describes the jumps in one line, or empty if there are none.
std::string FormatJumps(const std::vector<MotionJump>& jumps,
                        const std::vector<TrackedFrame>& frames);

// For metrics.json: the jumps, and what tracked each of these frames.
nlohmann::json JumpsToJson(const std::vector<MotionJump>& jumps,
                           const std::vector<TrackedFrame>& frames);

}  // namespace rgbd_pose
