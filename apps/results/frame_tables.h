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
inline constexpr char kCovarianceColumns[] =
    ",cov_wx_wx,cov_wx_wy,cov_wx_wz,cov_wx_cx,cov_wx_cy,cov_wx_cz,cov_wy_wy"
    ",cov_wy_wz,cov_wy_cx,cov_wy_cy,cov_wy_cz,cov_wz_wz,cov_wz_cx,cov_wz_cy"
    ",cov_wz_cz,cov_cx_cx,cov_cx_cy,cov_cx_cz,cov_cy_cy,cov_cy_cz,cov_cz_cz";

// frames.csv: a header and one row per input frame.
std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames);

// edges.csv: a header and one row per edge: ref and cur (rows of frames.csv; a
// ref below 0 is a keyframe of a loaded map), cur_from_ref (translation in m)
// and the upper triangle of its covariance.
std::string FormatEdgesCsv(const std::vector<TrackedFrame>& frames);

// Read a run's edges from edges.csv, or its frames with timestamps, statuses
// and edges. Throw InputError for missing or inconsistent files.
std::vector<RelativePose> ReadEdges(const std::filesystem::path& folder);
std::vector<TrackedFrame> ReadFrames(const std::filesystem::path& folder);

// errors.csv: one row per input frame; unknown values are empty cells. The true
// position nearest in time (m), the estimated one after alignment, and the
// errors of `report`, which must compare `path`, the poses of all frames that
// are not lost, with this truth: of the position, and of the motion over the
// interval that starts there.
std::string FormatErrorsCsv(const std::vector<TrackedFrame>& frames,
                            const Trajectory& path, const Trajectory& truth,
                            const EvaluationReport& report);

}  // namespace rgbd_pose
