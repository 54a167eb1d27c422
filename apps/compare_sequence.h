#pragma once

#include <string>
#include <vector>

#include "apps/odometry_run.h"
#include "core/evaluation.h"
#include "core/trajectory.h"
#include "frontend/dataset.h"

namespace rgbd_pose {

// What became of a sequence under one M-estimator.
struct LossRun {
  std::string loss;
  Trajectory trajectory;       // of the frames that were not lost
  double tracked_share = 0.0;  // 0 to 1
  EvaluationReport report;
};

// Tracks a sequence with several losses, the rest of the settings the same;
// every frame is read once. Throws InputError for unknown names and where a
// loss has no poses to judge.
std::vector<LossRun> CompareLosses(const Dataset& dataset,
                                   const Trajectory& truth,
                                   const std::vector<std::string>& losses,
                                   const OdometrySettings& settings,
                                   int threads);

// The end pose of runs along a path that ends where it starts: angle and
// translation that should be [0 0 0], as in the thesis' Tables 4.4-4.6.
std::string EndPoseTable(const std::vector<LossRun>& runs);

// Errors along the path, as in the thesis' Tables 4.7 and 4.8.
std::string PathErrorTable(const std::vector<LossRun>& runs);

// Top views X-Y and X-Z of the paths over the truth, all from a common first
// pose, as in the thesis' Figures 4.8 and 4.9. SVG.
std::string PathFigure(const std::string& title,
                       const std::vector<LossRun>& runs,
                       const Trajectory& truth);

// One row a loss with the figures of both tables, each row beginning with
// `name`; the header is kSequenceCsvHeader.
std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs);
extern const char kSequenceCsvHeader[];

}  // namespace rgbd_pose
