#pragma once

#include "core/estimation/correspondences.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// What a residual type over matches packs its columns from.
struct CostInput {
  const Correspondences& matches;
  Rigid3d cur_from_prev;               // weights are frozen at this motion
  const MotionPrior* prior = nullptr;  // null: nothing is known
};

}  // namespace rgbd_pose
