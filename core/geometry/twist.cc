#include "core/geometry/twist.h"

namespace rgbd_pose {

Rigid3d Twist::MotionDuring(double seconds) const {
  return Rigid3d::FromRotationVector(-seconds * angular, -seconds * linear);
}

Twist operator+(const Twist& a, const Twist& b) {
  return {a.angular + b.angular, a.linear + b.linear};
}

Twist operator-(const Twist& a, const Twist& b) {
  return {a.angular - b.angular, a.linear - b.linear};
}

Twist operator*(double factor, const Twist& twist) {
  return {factor * twist.angular, factor * twist.linear};
}

Twist TwistOf(const Rigid3d& later_from_earlier, double seconds) {
  return {-RotationVector(later_from_earlier.rotation) / seconds,
          -later_from_earlier.translation / seconds};
}

}  // namespace rgbd_pose
