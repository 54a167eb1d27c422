#pragma once

#include <ceres/loss_function.h>

#include <vector>

#include "benchmarks/simulated_graph.h"

namespace rgbd_pose {

// What a bundle adjustment did.
struct BundleSolution {
  std::vector<Rigid3d> poses;
  int iterations = 0;
  int residuals = 0;
};

// The yardstick of graphs: all poses but the first and all landmarks that at
// least two keyframes see, adjusted at once by Ceres (SPARSE_SCHUR): residuals
// in u, v and inverse depth with hand-written Jacobians, poses shared by all
// blocks of a keyframe. `loss` (or null) sees the 3 whitened rows of a
// sighting.
BundleSolution AdjustBundle(const SimulatedGraph& graph,
                            const std::vector<Rigid3d>& start,
                            ceres::LossFunction* loss);

}  // namespace rgbd_pose
