#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/alignment.h"
#include "core/evaluation/consistency.h"
#include "core/evaluation/relative_errors.h"
#include "core/evaluation/trajectory.h"
#include "core/evaluation/truth_alignment.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// How a trajectory is judged against the ground truth.
struct EvaluationOptions {
  // Poses belong together if their time stamps differ by no more than this (s);
  // a relative error may miss its interval by as much.
  double max_time_difference = 0.02;

  // The intervals of the relative pose errors: in time (s) and along the path
  // of the ground truth (m).
  double rpe_delta_seconds = 1.0;
  double rpe_delta_metres = 1.0;

  // And in frames, at least 1 each.
  std::vector<int> rpe_frames = {1, 6};

  // Off: both are in one world already, as poses within a map may be.
  bool align = true;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The error of the last pose relative to the first.
struct FinalPoseError {
  double translation = 0.0;  // m
  double angle = 0.0;        // rad
};

// The errors of one paired pose.
struct PoseError {
  double timestamp = 0.0;  // of the estimate, s
  double position = 0.0;   // after the alignment, m
  // Of rpe_seconds, for the interval that starts here; empty if none does.
  std::optional<double> rpe_translation;  // m
  std::optional<double> rpe_rotation;     // rad
};

// All figures are over poses paired in time (core/evaluation/association.h).
// Those of relative and final errors do not depend on the worlds of the
// trajectories.
struct EvaluationReport {
  EvaluationOptions options;  // that it was made with
  int estimated_poses = 0;    // in the estimate
  int paired_poses = 0;       // of those, with a ground truth
  double duration = 0.0;      // from the first to the last paired pose, s
  double path_length = 0.0;   // of the paired ground truth, m

  // Absolute trajectory error: distances (m) of positions after the rigid
  // alignment, without scale, by truth_from_estimate (of worlds; the identity
  // without alignment).
  ErrorStatistics ate;
  Rigid3d truth_from_estimate;

  // The same with scale, and what it says of the input.
  Sim3Alignment sim3;

  // Relative pose errors at fixed intervals. Every paired pose that has its
  // counterpart is a start:
  RelativePoseError rpe_frame;    // j is the next paired pose
  RelativePoseError rpe_seconds;  // j is nearest to rpe_delta_seconds later
  RelativePoseError rpe_metres;   // j is the first rpe_delta_metres or more on

  // Those over options.rpe_frames, in that order.
  std::vector<RelativePoseError> rpe_frames;

  // E from the first to the last paired pose; empty if there is but one.
  std::optional<FinalPoseError> final_pose;

  // ATE and RPE where the truth's clock and its fixing to the camera fit best.
  TruthAlignment truth_alignment;

  // How far the motions of a run keep to their covariances, if it has any.
  std::optional<RunConsistency> consistency;

  // What ate and rpe_seconds sum up: one a paired pose, in time order.
  std::vector<PoseError> poses;
};

// Judges an estimate. Throws InputError if the options are invalid or no
// poses belong together.
EvaluationReport Evaluate(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          const EvaluationOptions& options = {});

}  // namespace rgbd_pose
