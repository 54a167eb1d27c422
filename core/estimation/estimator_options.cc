#include "core/estimation/estimator_options.h"

namespace rgbd_pose {

std::string EstimatorOptions::Check() const {
  // Written so that a NaN fails each of them.
  if (!(gnc_factor >= 1.01)) return "gnc_factor must be at least 1.01";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (!(min_inlier_share >= 0.0 && min_inlier_share <= 1.0)) {
    return "min_inlier_share must lie between 0 and 1";
  }
  if (!(max_scale > 0.0)) return "max_scale must be positive";
  if (max_scale_rounds < 0) return "max_scale_rounds must not be negative";
  if (max_association_rounds < 1) {
    return "max_association_rounds must be at least 1";
  }
  if (threads < 1) return "threads must be at least 1";
  if (!(step_tolerance > 0.0)) return "step_tolerance must be positive";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  return "";
}

}  // namespace rgbd_pose
