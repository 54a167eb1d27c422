#pragma once

#include <vector>

#include "core/evaluation/pose_pairs.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The rigid motion truth_world_from_estimate_world, without scale, that brings
// the estimated positions nearest to the true ones in the sense of least
// squares (Horn 1987; Umeyama 1991). `pairs` must not be empty.
//
// Positions that are one point, lie on one line or stand still in one of the
// two lists leave rotations open. Of those, the one nearest to aligning the
// orientations of the first pair is taken; the least squares stay the same.
Rigid3d AlignRigidly(const std::vector<PosePair>& pairs);

}  // namespace rgbd_pose
