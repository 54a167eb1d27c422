#pragma once

#include <string>
#include <vector>

#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// errors.csv: one row an input frame; cells are empty where nothing is known.
// Positions (m) are in the world of the ground truth: the true one nearest in
// time and the estimated one after the alignment, which a lost frame lacks.
// Then the errors of `report`, which compares these frames with this truth: of
// the position, and of the motion over the interval that starts here.
std::string FormatErrorsCsv(const std::vector<TrackedFrame>& frames,
                            const Trajectory& truth,
                            const EvaluationReport& report);

}  // namespace rgbd_pose
