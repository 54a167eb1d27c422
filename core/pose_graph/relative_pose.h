#pragma once

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A measured motion between two frames, used to correct their poses later.
struct RelativePose {
  int ref = 0;                                     // the reference frame
  int cur = 0;                                     // the other frame
  Rigid3d cur_from_ref;                            // as measured
  MotionMatrix covariance = MotionMatrix::Zero();  // as in MotionEstimate
};

}  // namespace rgbd_pose
