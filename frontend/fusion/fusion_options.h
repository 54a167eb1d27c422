#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/util/units.h"
#include "frontend/frame/depth_lookup.h"

namespace rgbd_pose {

// What depth images are put together by.
struct FusionOptions {
  Camera camera;  // of all frames

  // Side of the cubes that points are merged in, or at whose corners distances
  // to the surface are kept (m): details of this size are left. Finer than the
  // noise of the sensor, more noise is held, not more detail.
  double voxel_size = 0.01;

  // Which depths are used, how far noise puts neighbours apart, and how much
  // each counts: by 1 / sigma^2.
  DepthLookupOptions depth;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

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
