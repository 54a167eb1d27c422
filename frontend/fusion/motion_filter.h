#pragma once

#include "core/geometry/rigid3.h"
#include "core/util/units.h"

namespace rgbd_pose {

// How far a camera has to get from one view to the next that is worth its time.
// Of a view 57 degrees wide, 3 degrees bring 5 % that were not seen before, and
// so do 5 cm at a distance of 1 m.
struct MotionFilter {
  double min_distance = 0.05;  // m
  double min_angle_deg = 3.0;  // whichever is reached first

  // Whether it got so far.
  bool IsReached(const Rigid3d& last_from_cur) const {
    return last_from_cur.translation.norm() >= min_distance ||
           last_from_cur.Angle() * kDegreesPerRadian >= min_angle_deg;
  }
};

}  // namespace rgbd_pose
