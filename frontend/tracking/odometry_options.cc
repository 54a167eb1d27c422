#include "frontend/tracking/odometry_options.h"

namespace rgbd_pose {

std::string OdometryOptions::Check() const {
  if (!(min_reference_share <= 1.0)) {
    return "min_reference_share must not be above 1";
  }
  if (!(max_flow_px > 0.0)) return "max_flow_px must be positive";
  if (!(new_segment_after >= 0.0)) {
    return "new_segment_after must not be negative";
  }
  if (!(guess_sigma_rotation > 0.0) || !(guess_sigma_translation > 0.0)) {
    return "the guess's standard deviations must be positive";
  }
  return "";
}

}  // namespace rgbd_pose
