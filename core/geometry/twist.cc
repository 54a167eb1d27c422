#include "core/geometry/twist.h"

#include <cmath>

namespace rgbd_pose {

Rigid3d Twist::MotionDuring(double seconds) const {
  const Eigen::Vector3d turn = -seconds * angular;
  const double angle = turn.norm();
  const Eigen::Vector3d axis =
      angle > 0.0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX();
  return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)),
                 -seconds * linear);
}

Twist TwistOf(const Rigid3d& later_from_earlier, double seconds) {
  // With w >= 0 the angle is at most half a turn.
  Eigen::Quaterniond q = later_from_earlier.rotation;
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const Eigen::AngleAxisd turn(q);
  return {-turn.angle() / seconds * turn.axis(),
          -later_from_earlier.translation / seconds};
}

}  // namespace rgbd_pose
