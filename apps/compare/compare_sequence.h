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

}  // namespace rgbd_pose
