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

// How a trajectory is compared with the ground truth.
struct EvaluationOptions {
  // Poses are paired if their timestamps differ by at most this (s). The
  // interval of a relative error in time may be off by the same amount.
  double max_time_difference = 0.02;

  // The intervals of the relative pose errors, in time and along the true path.
  double rpe_delta_seconds = 1.0;
  double rpe_delta_metres = 1.0;
  std::vector<int> rpe_frames = {1, 6};  // intervals in frames, at least 1 each

  // False if both are in the same world already, e.g. poses within a map.
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
  // From rpe_seconds, for the interval that starts here; empty if none does.
  std::optional<double> rpe_translation;  // m
  std::optional<double> rpe_rotation;     // rad
};

// All values are over poses paired in time (core/evaluation/association.h).
// Relative and final errors do not depend on the worlds of the trajectories.
struct EvaluationReport {
  EvaluationOptions options;  // the options used
  int estimated_poses = 0;    // in the estimate
  int paired_poses = 0;       // of these, with a ground truth
  double duration = 0.0;      // from the first to the last paired pose, s
  double path_length = 0.0;   // of the paired ground truth, m

  // Absolute trajectory error: distances (m) of positions after the alignment
  // by truth_from_estimate (between the worlds; without, the identity).
  ErrorStatistics ate;
  Rigid3d truth_from_estimate;

  // The alignment with scale, which can reveal errors of the input.
  Sim3Alignment sim3;

  // Relative pose errors from every paired pose i that has a counterpart j:
  RelativePoseError rpe_frame;    // j is the next paired pose
  RelativePoseError rpe_seconds;  // j is nearest to rpe_delta_seconds later
  RelativePoseError rpe_metres;   // j: first pose at least rpe_delta_metres on

  // Errors over options.rpe_frames, in this order.
  std::vector<RelativePoseError> rpe_frames;

  // Error of the last pose relative to the first; empty if there is only one.
  std::optional<FinalPoseError> final_pose;

  // ATE and RPE with the best-fitting time shift and fixing of the truth.
  TruthAlignment truth_alignment;

  // Consistency of a run's motions with their covariances, if it has any.
  std::optional<RunConsistency> consistency;

  // The errors in ate and rpe_seconds: one per paired pose, in time order.
  std::vector<PoseError> poses;
};

// Throws InputError for invalid options or if no poses can be paired.
EvaluationReport Evaluate(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          const EvaluationOptions& options = {});

}  // namespace rgbd_pose
