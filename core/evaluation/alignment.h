#pragma once

#include <string>
#include <vector>

#include "core/evaluation/association.h"
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

// How like the truth a path is, its size apart: a wrong depth scale or focal
// length keeps the shape and changes the size, a wrong file keeps neither.
struct Sim3Alignment {
  // By which the estimate's lengths become nearest to the true ones; 1 if the
  // estimate stands still.
  double truth_per_estimate = 1.0;

  // Root mean squares of distances (m): of the true positions from their mean,
  // and of the estimated ones, with that scale, from the true ones.
  double spread = 0.0;
  double residual_rmse = 0.0;
};

// `truth_from_estimate`: of worlds, by AlignRigidly, whose rotation is the best
// for any scale. `pairs` must not be empty.
Sim3Alignment Compare(const std::vector<PosePair>& pairs,
                      const Rigid3d& truth_from_estimate);

// One line that says what is likely wrong, or empty: the size is off by more
// than 10 %, or the shapes have little in common. `ate` is the root mean square
// of the distances (m) without scale.
std::string Sim3Warning(const Sim3Alignment& sim3, double ate);

}  // namespace rgbd_pose
