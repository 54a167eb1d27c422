#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/motion.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {

// The covariance of theta at a solution of a BundleAdjustment, all else being
// free too: once as the residuals' noise has it, and once as their scatter over
// the keyframes has it, whatever their noise. Both know the prior. Zero for
// what `origin` says is not free; false if they cannot be computed.
bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin,
                        const CalibrationState& state,
                        CalibrationMatrix* model_covariance,
                        CalibrationMatrix* sandwich_covariance);

// The normal equations of a bundle adjustment at a state. Unknowns are all
// poses but the first, six numbers each, then y of CalibrationOrigin; the
// depths of landmarks have been eliminated. Of landmarks alone: neither known
// distances nor the prior are in them.
struct ReducedCameraSystem {
  Eigen::MatrixXd hessian;  // only its lower triangle

  // Of the landmarks of each anchor: a column a keyframe.
  Eigen::MatrixXd gradients;

  // By how much less than `hessian` the gradients change with the unknowns, as
  // residuals lose weight where they grow: sums of rho' p + 2 s rho'' and of
  // rho' p over residuals of p rows and s = |r|^2.
  double slope_p = 0.0, weight_p = 0.0;

  // Where a pose is among the unknowns; negative: the first, which is none.
  static int PlaceOfPose(int keyframe) { return 6 * (keyframe - 1); }
  int PlaceOfY() const {
    return static_cast<int>(hessian.rows()) - kCalibrationSize;
  }
};

// `poses` are those of `state`. Residuals have Cauchy's loss.
ReducedCameraSystem MakeReducedCameraSystem(
    const CalibrationViews& views, bool training_only,
    const CalibrationOrigin& origin, const CalibrationState& state,
    const std::vector<MotionDerivatives>& poses);

}  // namespace rgbd_pose
