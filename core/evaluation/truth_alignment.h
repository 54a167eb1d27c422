#pragma once

#include <string>
#include <vector>

#include "core/evaluation/fixing_equations.h"
#include "core/evaluation/relative_errors.h"
#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// The clocks may differ, and a motion capture system tracks markers whose pose
// relative to the camera is only known to about a degree. This is the clock
// shift and fixing at which estimate and truth agree best, found from motions
// of 0.2 s, and the remaining errors. As it also removes errors of the estimate
// that look like these effects, the plain errors should be shown first.
struct TruthAlignment {
  // Why the alignment is missing, as one line; empty if it exists.
  std::string skipped;

  int motions = 0;     // number of motions used
  TruthFixing fixing;  // 0 in directions that the motion does not determine

  // Standard deviations of shift (s), rotation (rad, about the camera's axes)
  // and lever (m, along these axes), with correlations over time; infinite for
  // parameters that the motion does not determine.
  FixingVector sigma = FixingVector::Zero();

  // Names of parameters that the motion does not determine to 20 ms, 2 degrees
  // and 5 cm, or for which estimate and truth have too little in common.
  std::vector<std::string> undetermined;

  // Errors with this fixing and the truth interpolated: distances (m) after a
  // rigid alignment, and relative errors over rpe_delta_seconds.
  ErrorStatistics ate;
  RelativePoseError rpe_seconds;
};

// `rpe_delta_seconds` and `max_time_difference` (s): as in EvaluationOptions.
TruthAlignment AlignTruth(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          double rpe_delta_seconds, double max_time_difference);

}  // namespace rgbd_pose
