#include "frontend/tracking/recent_motion.h"

namespace rgbd_pose {

// To first order: turn and shift by their share.
Rigid3d RecentMotion::During(double seconds) const {
  const double share = seconds / interval_;
  const Eigen::AngleAxisd turn(cur_from_prev_.rotation);
  return Rigid3d(
      Eigen::Quaterniond(Eigen::AngleAxisd(share * turn.angle(), turn.axis())),
      share * cur_from_prev_.translation);
}

}  // namespace rgbd_pose
