#pragma once

#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/evaluation/truth_noise.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// Squared error of an edge, [omega C], in units of its covariance plus `noise`:
// chi^2 with 6 degrees of freedom if the covariance is correct.
double ChiSquare(const RelativePose& edge, const Rigid3d& true_cur_from_ref,
                 const TruthNoise& noise);

// A motion with a larger chi^2 counts as wrong: 0.3 in a million, as many as
// exceed five sigmas in one dimension.
constexpr double kWrongChiSquare = 40.9;

// Consistency of motions with their covariances.
struct Consistency {
  int count = 0;        // motions that could be checked
  int wrong = 0;        // of these, with a chi^2 above kWrongChiSquare
  double nees = 0.0;    // the mean of chi^2 / 6
  double median = 0.0;  // the median of chi^2 / 6
};

// Consistency of the motions of a run.
struct RunConsistency {
  TruthNoise truth_noise;  // used for the checks
  int ok = 0;              // frames with this status
  Consistency ok_frames;   // of these, by the motion that gave the pose
  Consistency edges;       // all motions, also of other frames

  // The ok frames once more, with the truth's clock shifted by what fits best
  // (TruthFixing::shift); no count if that is not known.
  Consistency in_time = {};
};

// Judges edges by the truth, interpolated at the `times` (s) of their frames.
// Skips edges without a covariance or without the truth, and those from what is
// no frame of these: a keyframe of a map has a number below 0.
Consistency Judge(const std::vector<RelativePose>& edges,
                  const std::vector<double>& times, const Trajectory& truth,
                  const TruthNoise& noise);

}  // namespace rgbd_pose
