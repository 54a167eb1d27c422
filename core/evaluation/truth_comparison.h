#pragma once

#include <optional>
#include <vector>

#include "core/evaluation/fixing_equations.h"
#include "core/evaluation/fixing_parameters.h"
#include "core/evaluation/interpolated_path.h"
#include "core/evaluation/moving_poses.h"
#include "core/evaluation/pose_pairs.h"
#include "core/evaluation/relative_errors.h"
#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// An estimate beside the truth, interpolated, with any clock and fixing. Both
// trajectories have to outlive it.
class TruthComparison {
 public:
  // What the compared motions take: long enough for motion to outweigh noise,
  // short enough for drift not to count.
  static constexpr double kMotionSeconds = 0.2;

  TruthComparison(const Trajectory& estimate, const Trajectory& ground_truth);

  // Motions of the estimate that the truth has, too, in time order; of very
  // many, some.
  std::vector<ComparedMotion> Motions(const TruthFixing& fixing) const;

  // Poses of the estimate and those that the camera had by the truth.
  std::vector<PosePair> Pairs(const TruthFixing& fixing) const;

 private:
  // Of the camera, at the times of the estimate.
  std::vector<std::optional<Rigid3d>> Truth(const TruthFixing& fixing) const;

  const Trajectory& estimate_;
  InterpolatedPath path_;
  std::vector<double> times_;  // of the estimate, s
  std::vector<std::optional<MovingPose>> moving_estimate_;
  std::vector<PoseInterval> intervals_;
};

}  // namespace rgbd_pose
