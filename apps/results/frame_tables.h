#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// tx ty tz qx qy qz qw, each after the separator.
std::string FormatPose(const Rigid3d& pose, char separator = ',');

// The upper triangle of a 6 x 6 matrix, row by row, each after the separator;
// and the names of these columns for a covariance (see MotionEstimate).
std::string FormatTriangle(const MotionMatrix& matrix, char separator = ',');
extern const char kCovarianceColumns[];

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

// errors.csv: one row an input frame; cells are empty where nothing is known.
// Positions (m) are in the world of the ground truth: the true one nearest in
// time and the estimated one after the alignment, which a lost frame lacks.
// Then the errors of `report`, which compares these frames with this truth: of
// the position, and of the motion over the interval that starts here.
std::string FormatErrorsCsv(const std::vector<TrackedFrame>& frames,
                            const Trajectory& truth,
                            const EvaluationReport& report);

}  // namespace rgbd_pose
