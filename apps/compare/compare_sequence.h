#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "frontend/sources/frame_source.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// What became of a sequence under one M-estimator.
struct LossRun {
  std::string loss;
  std::vector<TrackedFrame> frames;  // all of the sequence
  Trajectory trajectory;             // of the frames that were not lost
  // Against the ground truth; empty if there is none or all frames are lost.
  std::optional<EvaluationReport> report;

  // Share of frames with a pose, 0 to 1.
  double TrackedShare() const {
    return static_cast<double>(trajectory.size()) / frames.size();
  }
};

// Tracks a sequence with several losses, the rest of the settings the same;
// every frame is read once. Throws InputError for unknown names and for a
// ground truth of other times.
std::vector<LossRun> CompareLosses(FrameSource* source,
                                   const std::optional<Trajectory>& truth,
                                   const std::vector<std::string>& losses,
                                   const OdometrySettings& settings,
                                   int threads);

}  // namespace rgbd_pose
