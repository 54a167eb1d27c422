#pragma once

#include <Eigen/Core>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The velocity of a camera in its own axes at some moment, and how fast it
// changes around it. The accelerations are 0 unless they were measured.
struct Twist {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();               // rad/s
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();                // m/s
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // rad/s^2
  Eigen::Vector3d linear_acceleration = Eigen::Vector3d::Zero();   // m/s^2

  // The velocity `seconds` later (negative: earlier).
  Twist After(double seconds) const;

  // The constant velocity that makes the same motion in `seconds`.
  Twist Mean(double seconds) const;

  // later_from_earlier over a time span in seconds (negative: backwards), for
  // fractions of a second: the translation is exact to first order.
  Rigid3d MotionDuring(double seconds) const;

  // earlier_from_later over the same span, as MotionDuring.
  Rigid3d MotionBack(double seconds) const;

  // A static point (camera axes, m) as seen after `seconds`, to second order.
  template <typename T>
  void MovePoint(const T* point, const T& seconds, T* moved) const {
    const T half = 0.5 * seconds;
    T w[3], v[3], a[3];  // the mean velocity until then; that of the point
    for (int i = 0; i < 3; ++i) {
      w[i] = angular[i] + half * angular_acceleration[i];
      v[i] = linear[i] + half * linear_acceleration[i];
    }
    a[0] = w[2] * point[1] - w[1] * point[2] - v[0];
    a[1] = w[0] * point[2] - w[2] * point[0] - v[1];
    a[2] = w[1] * point[0] - w[0] * point[1] - v[2];
    moved[0] = point[0] + seconds * (a[0] - half * (w[1] * a[2] - w[2] * a[1]));
    moved[1] = point[1] + seconds * (a[1] - half * (w[2] * a[0] - w[0] * a[2]));
    moved[2] = point[2] + seconds * (a[2] - half * (w[0] * a[1] - w[1] * a[0]));
  }

  // Where a point was that is seen after `seconds`. With accelerations this is
  // not MovedPoint with negative seconds.
  Eigen::Vector3d MovedBack(const Eigen::Vector3d& point,
                            double seconds) const {
    return Mean(seconds).MovedPoint(point, -seconds);
  }

  // The velocity (m/s) of a static point in the camera's axes.
  template <typename T>
  void PointVelocity(const T* point, T* velocity) const {
    const Eigen::Vector3d& w = angular;
    velocity[0] = w[2] * point[1] - w[1] * point[2] - linear[0];
    velocity[1] = w[0] * point[2] - w[2] * point[0] - linear[1];
    velocity[2] = w[1] * point[0] - w[0] * point[1] - linear[2];
  }

  // MovePoint for one point.
  Eigen::Vector3d MovedPoint(const Eigen::Vector3d& point,
                             double seconds) const {
    Eigen::Vector3d moved;
    MovePoint(point.data(), seconds, moved.data());
    return moved;
  }
};

// Operators for weighted sums of twists.
Twist operator+(const Twist& a, const Twist& b);
Twist operator-(const Twist& a, const Twist& b);
Twist operator*(double factor, const Twist& twist);

// The constant twist that makes a motion in `seconds`, which must not be 0.
Twist TwistOf(const Rigid3d& later_from_earlier, double seconds);

// Exposure times of the rows of an image: row r of H is exposed at
//
//   stamp + offset + readout ((r + 1/2) / H - 1/2)
//
// in seconds. The readout time, from the first row to the last, is negative if
// the last row comes first, 0 for a global shutter.
struct Shutter {
  double offset = 0.0;   // of the middle row, relative to the timestamp, s
  double readout = 0.0;  // s

  // Whether they were given; if not, covariances allow for 5 ms of motion.
  bool is_known = false;

  // Whether all rows are exposed at the timestamp.
  bool IsGlobal() const { return offset == 0.0 && readout == 0.0; }

  // Exposure time of a row (px, may be fractional) after the timestamp, s.
  double RowTime(double row, int height) const {
    return offset + readout * ((row + 0.5) / height - 0.5);
  }
};

// Exposure times of the images of a frame, and the camera's motion meanwhile.
struct FrameTiming {
  Shutter color;  // relative to the frame's timestamp
  Shutter depth;  // also relative to the frame's timestamp
  Twist twist;    // at the timestamp

  // Whether everything was exposed at the timestamp.
  bool IsOneMoment() const { return color.IsGlobal() && depth.IsGlobal(); }
};

}  // namespace rgbd_pose
