#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"

namespace rgbd_pose {

// A measured motion between two keyframes.
struct KeyframePair {
  RelativePose edge;        // between numbers
  bool is_tracked = false;  // by the odometry; hardly ever wrong
  bool is_loop = false;     // joins what was far apart
};

// How far a measured motion may be off: what its covariance says, a floor, and
// what a camera that is not quite as its calibration says makes of a motion, an
// error in proportion to it (the proportional error).
class EdgeNoiseModel {
 public:
  // See MappingOptions.
  explicit EdgeNoiseModel(double drift);

  // By what share of itself a motion is off beyond its covariance, as the pairs
  // disagree: 0 where the camera is as its calibration says.
  double proportional_error() const { return proportional_error_; }

  // Finds the proportional error with which half of the pairs agree with the
  // motions that poses have, one for each, as well as their covariances say.
  // Pairs that were tracked do not count: poses follow them too closely.
  void FitProportionalError(const std::vector<KeyframePair>& pairs,
                            const std::vector<Rigid3d>& cur_from_ref);

  // With floor and proportional error.
  MotionMatrix CovarianceOf(const RelativePose& edge) const;

  // Under which a pair takes part.
  const ceres::LossFunction* LossOf(const KeyframePair& pair) const;

  // The covariance with which a pair counts where poses have this motion: the
  // larger the less its loss lets it count.
  MotionMatrix CovarianceAsSolved(const KeyframePair& pair,
                                  const Rigid3d& cur_from_ref) const;

  // Whether a motion may be right, as far as a way between the two, as poses
  // from its `ref` to its `cur`, says: chi^2 of 6 degrees below its 99.9 %
  // quantile.
  bool PassesMahalanobisGate(const RelativePose& edge,
                             const std::vector<Rigid3d>& map_from_cam) const;

 private:
  MotionMatrix CovarianceOf(const RelativePose& edge,
                            double proportional_error) const;

  const double drift_;
  std::unique_ptr<ceres::LossFunction> tracked_loss_, pair_loss_;
  double proportional_error_ = 0.0;
};

}  // namespace rgbd_pose
