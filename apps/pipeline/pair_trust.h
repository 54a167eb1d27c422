#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <string>
#include <vector>

#include "core/estimation/edge.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// How far measured motions between keyframes are believed.
struct PairTrustOptions {
  // What noise models do not know (calibration, stamps): at least so much is a
  // pair off.
  double min_sigma_rotation = 1e-4;       // rad
  double min_sigma_translation = 2.5e-4;  // m

  // By what share of the way and of the turns a path drifts at most, as one
  // standard deviation: what a loop may correct.
  double drift = 0.01;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// A measured motion between two keyframes.
struct KeyframePair {
  Edge edge;                // between numbers
  bool is_tracked = false;  // by the odometry; hardly ever wrong
  bool is_loop = false;     // joins what was far apart
};

// How far a measured motion may be off: what its covariance says, a floor, and
// what a camera that is not quite as its calibration says makes of a motion, an
// error in proportion to it (the slack).
class PairTrust {
 public:
  // Throws InputError for options that are not sound (see Check).
  explicit PairTrust(const PairTrustOptions& options);

  // By what share of itself a motion is off beyond its covariance, as the pairs
  // disagree: 0 where the camera is as its calibration says.
  double slack() const { return slack_; }

  // Finds the slack with which half of the pairs agree with the motions that
  // poses have, one for each, as well as their covariances say. Pairs that were
  // tracked do not count: poses follow them too closely.
  void FitSlack(const std::vector<KeyframePair>& pairs,
                const std::vector<Rigid3d>& cur_from_ref);

  // With floor and slack.
  MotionMatrix CovarianceOf(const Edge& edge) const;

  // Under which a pair takes part.
  const ceres::LossFunction* LossOf(const KeyframePair& pair) const;

  // The covariance with which a pair counts where poses have this motion: the
  // larger the less its loss lets it count.
  MotionMatrix CovarianceAsSolved(const KeyframePair& pair,
                                  const Rigid3d& cur_from_ref) const;

  // Whether a motion may be right, as far as a way between the two, as poses
  // from its `ref` to its `cur`, tells: chi^2 of 6 degrees below its 99.9 %
  // quantile.
  bool IsPlausible(const Edge& edge,
                   const std::vector<Rigid3d>& map_from_cam) const;

 private:
  MotionMatrix CovarianceOf(const Edge& edge, double slack) const;

  const PairTrustOptions options_;
  std::unique_ptr<ceres::LossFunction> tracked_loss_, pair_loss_;
  double slack_ = 0.0;
};

}  // namespace rgbd_pose
