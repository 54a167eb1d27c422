#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/odometry_run.h"

namespace rgbd_pose {

// The results of a sequence with one M-estimator.
struct LossRun : RunResults {
  std::string loss;
};

// Tracks a sequence with several losses and otherwise equal settings. Every
// frame is read once. Throws InputError for unknown names and for a ground
// truth that does not overlap in time.
std::vector<LossRun> CompareLosses(FrameSource* source,
                                   const std::optional<Trajectory>& truth,
                                   const std::vector<std::string>& losses,
                                   OdometrySettings settings, int threads);

// The last pose of each run relative to its first pose, in the thesis'
// parameters and as an angle and a distance, as in its Tables 4.4-4.6. With
// `returns_to_start`, the first row has the true values: [0 0 0] twice.
std::string EndPoseTable(const std::vector<LossRun>& runs,
                         bool returns_to_start);

// Errors along the path, as in the thesis' Tables 4.7 and 4.8; n/a if unknown.
std::string PathErrorTable(const std::vector<LossRun>& runs);

// The share of tracked frames of each run. Used when there are no errors.
std::string TrackedLine(const std::vector<LossRun>& runs);

// tables.csv: one row per loss with the figures of both tables. Each row starts
// with `name` (of the sequence); unknown figures are empty cells.
std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs);
extern const char kSequenceCsvHeader[];

}  // namespace rgbd_pose
