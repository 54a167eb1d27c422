#pragma once

#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/pose_graph/relative_pose.h"

namespace rgbd_pose {

// How much a motion of the truth itself is off, in each direction: 0 for
// rendered sequences.
struct TruthNoise {
  double translation = 0.0;  // sigma, m
  double rotation = 0.0;     // sigma, rad
};

// chi^2 of 6 degrees of freedom: the squared error of an edge, [omega C] as
// MotionEstimate has it, in units of its covariance. 6 in the mean if that is
// honest; of a million honest ones 0.3 exceed kWrongChiSquare, as they exceed
// five sigmas of one degree of freedom.
double ChiSquare(const RelativePose& edge, const Rigid3d& true_cur_from_ref,
                 const TruthNoise& noise);

// Above this chi^2 a motion is called wrong.
constexpr double kWrongChiSquare = 40.9;

// What motions are worth that say how certain they are.
struct Consistency {
  int count = 0;        // motions that could be judged
  int wrong = 0;        // of these, with a chi^2 above kWrongChiSquare
  double nees = 0.0;    // the mean of chi^2 / 6
  double median = 0.0;  // that of chi^2 / 6
};

// What those of a run are worth.
struct RunConsistency {
  TruthNoise truth_noise;  // that it was found with
  int ok = 0;              // frames with this status
  Consistency ok_frames;   // of them, by the motion that gave the pose
  Consistency edges;       // all motions, of other frames, too
};

// Of edges with covariances between frames that have the truth at their time
// (s, by index); it is interpolated.
Consistency Judge(const std::vector<RelativePose>& edges,
                  const std::vector<double>& times, const Trajectory& truth,
                  const TruthNoise& noise);

}  // namespace rgbd_pose
