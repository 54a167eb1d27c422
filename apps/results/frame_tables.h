#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// tx ty tz qx qy qz qw, each after a separator.
std::string FormatPose(const Rigid3d& pose, char separator = ',');

// The upper triangle of a 6 x 6 matrix, row by row, each value after a
// separator, and the column names for a covariance (see MotionEstimate).
std::string FormatTriangle(const MotionMatrix& matrix, char separator = ',');
extern const char kCovarianceColumns[];

// frames.csv: a header and one row per input frame.
std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames);

// edges.csv: a header and one row per edge. Frames are numbered by the rows of
// frames.csv. Each row has cur_from_ref as translation (m) and quaternion, then
// the upper triangle of its covariance, row by row (see MotionEstimate).
std::string FormatEdgesCsv(const std::vector<TrackedFrame>& frames);

// Read a run's edges from edges.csv, or its frames with timestamps, statuses
// and edges. Throw InputError for missing or inconsistent files.
std::vector<RelativePose> ReadEdges(const std::filesystem::path& folder);
std::vector<TrackedFrame> ReadFrames(const std::filesystem::path& folder);

// errors.csv: one row per input frame; unknown values are empty cells.
// Positions (m) are in the world of the ground truth: the true position nearest
// in time and the estimated position after alignment (empty for a lost frame).
// Then the errors of `report`, which must compare these frames with this truth:
// of the position, and of the motion over the interval that starts there.
std::string FormatErrorsCsv(const std::vector<TrackedFrame>& frames,
                            const Trajectory& truth,
                            const EvaluationReport& report);

}  // namespace rgbd_pose
