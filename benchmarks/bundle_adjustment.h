#pragma once

#include <ceres/loss_function.h>

#include <vector>

#include "benchmarks/simulated_graph.h"

namespace rgbd_pose {

// The result of a bundle adjustment.
struct BundleSolution {
  std::vector<Rigid3d> poses;
  int iterations = 0;
  int residuals = 0;
};

// The reference method for graphs. Ceres (SPARSE_SCHUR) adjusts all poses but
// the first and all landmarks observed by at least two keyframes at once:
// residuals in u, v and inverse depth with hand-written Jacobians, one
// parameter block for the pose of each keyframe. `loss` (or null) applies to
// the 3 whitened rows of an observation.
BundleSolution AdjustBundle(const SimulatedGraph& graph,
                            const std::vector<Rigid3d>& start,
                            ceres::LossFunction* loss);

}  // namespace rgbd_pose
