#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"

namespace rgbd_pose {

// A measured motion between two keyframes.
struct KeyframePair {
  RelativePose edge;        // ref and cur are keyframe numbers
  bool is_tracked = false;  // by the odometry, which is hardly ever wrong
  bool is_loop = false;     // links keyframes that were far apart in the graph
};

// Uncertainty of measured motions: their covariance, a noise floor, and an
// error proportional to the motion (the proportional error), which is caused by
// an inaccurate calibration.
class EdgeNoiseModel {
 public:
  // See MappingOptions.
  explicit EdgeNoiseModel(double drift);

  // The error relative to the motion that explains the disagreement of pairs
  // beyond their covariances. 0 if the calibration is accurate.
  double proportional_error() const { return proportional_error_; }

  // Finds the proportional error with which the median disagreement between the
  // pairs and the motions by the current poses (`cur_from_ref`, one per pair)
  // is as expected from the covariances. Tracked pairs are ignored, as the
  // poses follow them too closely.
  void FitProportionalError(const std::vector<KeyframePair>& pairs,
                            const std::vector<Rigid3d>& cur_from_ref);

  // The covariance with noise floor and proportional error.
  MotionMatrix CovarianceOf(const RelativePose& edge) const;

  // The loss function of a pair.
  const ceres::LossFunction* LossOf(const KeyframePair& pair) const {
    return pair.is_tracked ? tracked_loss_.get() : pair_loss_.get();
  }

  // The effective covariance of a pair if the motion by the poses is
  // `cur_from_ref`: larger if the loss function reduces the pair's weight.
  MotionMatrix CovarianceAsSolved(const KeyframePair& pair,
                                  const Rigid3d& cur_from_ref) const;

  // Whether a motion is consistent with the poses of a path from its `ref` to
  // its `cur`: chi^2 with 6 degrees of freedom is below its 99.9 % quantile.
  bool PassesMahalanobisGate(const RelativePose& edge,
                             const std::vector<Rigid3d>& map_from_cam) const;

 private:
  const double drift_;
  std::unique_ptr<ceres::LossFunction> tracked_loss_, pair_loss_;
  double proportional_error_ = 0.0;
};

}  // namespace rgbd_pose
