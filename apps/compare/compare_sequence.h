#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/odometry_run.h"

namespace rgbd_pose {

// What became of a sequence under one M-estimator.
struct LossRun : RunResults {
  std::string loss;
};

// Tracks a sequence with several losses, the rest of the settings the same;
// every frame is read once. Throws InputError for unknown names and for a
// ground truth of other times.
std::vector<LossRun> CompareLosses(FrameSource* source,
                                   const std::optional<Trajectory>& truth,
                                   const std::vector<std::string>& losses,
                                   OdometrySettings settings, int threads);

// The last pose of each run seen from its first one, in the thesis' parameters
// and as an angle and a distance; as in its Tables 4.4-4.6. With
// `returns_to_start` the first row is what should be there: [0 0 0] twice.
std::string EndPoseTable(const std::vector<LossRun>& runs,
                         bool returns_to_start);

// Errors along the path, as in the thesis' Tables 4.7 and 4.8; n/a where there
// is nothing to judge.
std::string PathErrorTable(const std::vector<LossRun>& runs);

// The shares of frames tracked, where there are no errors to tell.
std::string TrackedLine(const std::vector<LossRun>& runs);

// tables.csv: one row a loss with the figures of both tables, each row
// beginning with `name` (of the sequence); cells without a figure are empty.
std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs);
extern const char kSequenceCsvHeader[];

}  // namespace rgbd_pose
