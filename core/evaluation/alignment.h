#pragma once

#include <string>
#include <vector>

#include "core/evaluation/association.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The rigid motion truth_world_from_estimate_world, without scale, that
// minimises the squared distances between estimated and true positions (Horn
// 1987; Umeyama 1991). `pairs` must not be empty.
//
// If the positions of a list coincide or lie on one line, rotations remain
// free: then the one that best aligns the orientations of the first pair.
Rigid3d AlignRigidly(const std::vector<PosePair>& pairs);

// Similarity of a path to the truth, apart from its size. A wrong depth scale
// or focal length changes only the size; a wrong file the shape, too.
struct Sim3Alignment {
  // The scale that fits the estimate best; 1 if it does not move.
  double truth_per_estimate = 1.0;

  // Root mean squares of distances (m): of the true positions from their mean,
  // and of the scaled estimated positions from the true ones.
  double spread = 0.0;
  double residual_rmse = 0.0;
};

// `truth_from_estimate` (between the worlds) is the result of AlignRigidly,
// whose rotation is the best for any scale. `pairs` must not be empty.
Sim3Alignment Compare(const std::vector<PosePair>& pairs,
                      const Rigid3d& truth_from_estimate);

// One line that says what is probably wrong, or empty: the size is off by more
// than 10 %, or the shapes have little in common. `ate` is the root mean square
// of the distances (m) without scale.
std::string Sim3Warning(const Sim3Alignment& sim3, double ate);

}  // namespace rgbd_pose
