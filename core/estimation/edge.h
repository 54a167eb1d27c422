#pragma once

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A measured motion between two frames of a sequence: what poses can be
// corrected by later.
struct Edge {
  int ref = 0, cur = 0;  // the two frames
  Rigid3d cur_from_ref;
  MotionMatrix covariance = MotionMatrix::Zero();  // as MotionEstimate's
};

}  // namespace rgbd_pose
