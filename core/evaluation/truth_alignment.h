#pragma once

#include <string>
#include <vector>

#include "core/evaluation/fixing_equations.h"
#include "core/evaluation/relative_errors.h"
#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// Two clocks need not agree, and what a motion capture system follows is not
// the camera but markers, whose fixing to it is known to a degree or so. This
// is the clock and the fixing at which an estimate and the truth agree best,
// found from motions of 0.2 s, and the errors that are left there. Part of an
// error of the estimate that looks like one of these is taken away, too: the
// plain errors stay the ones to be shown first.
struct TruthAlignment {
  // Why there is none, one line; empty: there is one.
  std::string skipped;

  int motions = 0;     // that it was found from
  TruthFixing fixing;  // 0 in directions that the motion does not determine

  // Standard deviations of shift (s), rotation (rad) and lever (m; both about
  // and along the camera's axes), with motions' correlations over time taken
  // into account; infinite where the motion does not determine one.
  FixingVector sigma = FixingVector::Zero();

  // Names of what the motion does not determine to 20 ms, 2 degrees and 5 cm,
  // or on which estimate and truth have too little in common.
  std::vector<std::string> undetermined;

  // Errors with the truth interpolated there, over as many poses as `ate`
  // counts: distances (m) after a rigid alignment, and of motions that take
  // rpe_delta_seconds.
  ErrorStatistics ate;
  RelativePoseError rpe_seconds;
};

// `rpe_delta_seconds` and `max_time_difference` (s): as in EvaluationOptions.
TruthAlignment AlignTruth(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          double rpe_delta_seconds, double max_time_difference);

}  // namespace rgbd_pose
