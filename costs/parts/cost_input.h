#pragma once

#include "core/estimation/correspondences.h"
#include "core/estimation/motion_prior.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Of residual types: see the lists of costs.
template <typename... Types>
struct TypeList {};

// What a residual type over matches packs its columns from.
struct CostInput {
  const Correspondences& matches;
  Rigid3d cur_from_prev;  // where weights that depend on the motion are frozen
  const MotionPrior* prior = nullptr;  // null: nothing is known
};

}  // namespace rgbd_pose
