#pragma once

#include <string>
#include <vector>

#include "core/estimation/motion_cost.h"

namespace rgbd_pose {

// How losses get to their widths.
enum class RobustSchedule {
  kDirect,  // at once: right where the guess is within their widths
  kGnc,     // graduated non-convexity: so wide at first that all matches
            // count, then narrower step by step
};

// How a motion is estimated.
struct EstimatorOptions {
  // How matches become residual blocks; the result does not depend on it.
  Assembly assembly = Assembly::kCompressed;

  // How losses get to their widths.
  RobustSchedule schedule = RobustSchedule::kGnc;

  // Each stage of the graduation narrows the losses by this factor (at least
  // 1.01), or at once to the spread of the residuals.
  double gnc_factor = 2.0;

  // Estimates the spread of residual components in units of the noise model,
  // to which the widths are then matched; may reorder its argument. Null: the
  // noise model is taken as it is.
  double (*scale)(std::vector<double>* residuals) = nullptr;

  // Scale and motion are estimated in turn, at most so often.
  int max_scale_rounds = 10;

  // How often costs whose residuals or weights depend on the motion choose them
  // again in the last stage, where the motion goes on changing.
  int max_association_rounds = 3;

  // Where residuals are chosen at every step, one that moves by less (rad and
  // m) is the last.
  double step_tolerance = 1e-6;

  // Of the solver, in the last stage; the stages before take at most two.
  int max_iterations = 50;

  // The estimate is `inconsistent` if a smaller share of matches agrees.
  double min_inlier_share = 0.2;

  // It is `inconsistent` as well if the estimated scale exceeds this: matches
  // so much noisier than the noise model are wrong ones.
  double max_scale = 5.0;

  // A direction of motion is `degenerate` if its standard deviation exceeds
  // this (rad for rotation, m for translation).
  double max_standard_deviation = 0.5;

  // Threads that sums over tens of thousands of matches may take. The result is
  // the same to the last bit.
  int threads = 1;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
