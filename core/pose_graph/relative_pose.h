#pragma once

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A measured motion between two frames of a sequence: what poses can be
// corrected by later.
struct RelativePose {
  int ref = 0;                                     // the one frame
  int cur = 0;                                     // the other
  Rigid3d cur_from_ref;                            // as measured
  MotionMatrix covariance = MotionMatrix::Zero();  // as MotionEstimate's
};

}  // namespace rgbd_pose
