#include "core/geometry/twist.h"

namespace rgbd_pose {

Twist Twist::After(double seconds) const {
  Twist later = *this;
  later.angular += seconds * angular_acceleration;
  later.linear += seconds * linear_acceleration;
  return later;
}

Twist Twist::Mean(double seconds) const {
  const double half = 0.5 * seconds;
  return {angular + half * angular_acceleration,
          linear + half * linear_acceleration};
}

Rigid3d Twist::MotionDuring(double seconds) const {
  const Twist mean = Mean(seconds);
  return Rigid3d::FromRotationVector(-seconds * mean.angular,
                                     -seconds * mean.linear);
}

Rigid3d Twist::MotionBack(double seconds) const {
  return Mean(seconds).MotionDuring(-seconds);
}

Twist operator+(const Twist& a, const Twist& b) {
  return {a.angular + b.angular, a.linear + b.linear,
          a.angular_acceleration + b.angular_acceleration,
          a.linear_acceleration + b.linear_acceleration};
}

Twist operator-(const Twist& a, const Twist& b) {
  return {a.angular - b.angular, a.linear - b.linear,
          a.angular_acceleration - b.angular_acceleration,
          a.linear_acceleration - b.linear_acceleration};
}

Twist operator*(double factor, const Twist& twist) {
  return {factor * twist.angular, factor * twist.linear,
          factor * twist.angular_acceleration,
          factor * twist.linear_acceleration};
}

Twist TwistOf(const Rigid3d& later_from_earlier, double seconds) {
  Twist twist;
  twist.angular = -RotationVector(later_from_earlier.rotation) / seconds;
  twist.linear = -later_from_earlier.translation / seconds;
  return twist;
}

}  // namespace rgbd_pose
