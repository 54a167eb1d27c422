#include "frontend/tracking/tracker.h"

#include <Eigen/LU>

namespace rgbd_pose {

std::string TrackerOptions::Check() const {
  if (min_inliers < 3) return "min_inliers must be at least 3";
  if (min_inliers_ok < min_inliers) {
    return "min_inliers_ok must not be below min_inliers";
  }
  if (!(min_inlier_share_ok <= 1.0)) {
    return "min_inlier_share_ok must not be above 1";
  }
  if (!(max_sigma_ok > 0.0)) return "max_sigma_ok must be positive";
  if (!(prior_sigma_rotation > 0.0) || !(prior_sigma_translation > 0.0)) {
    return "the prior's standard deviations must be positive";
  }
  if (!(min_seen_share >= 0.0 && min_seen_share <= 1.0)) {
    return "min_seen_share must be from 0 to 1";
  }
  if (!(min_likeness >= -1.0 && min_likeness <= 1.0)) {
    return "min_likeness must be from -1 to 1";
  }
  return "";
}

MotionPrior PriorOf(const TrackerOptions& options, const TrackingGuess& guess) {
  if (guess.covariance != nullptr) {
    return {guess.cur_from_ref, guess.covariance->inverse()};
  }
  return {guess.cur_from_ref,
          IndependentErrors(1.0 / options.prior_sigma_rotation,
                            1.0 / options.prior_sigma_translation)};
}

}  // namespace rgbd_pose
