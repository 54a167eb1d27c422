#pragma once

#include <ceres/autodiff_cost_function.h>

#include <memory>

#include "core/pose_graph/graph_blocks.h"

namespace rgbd_pose {

struct EdgeFunctor {
  template <typename T>
  bool operator()(const T* x_ref, const T* x_cur, T* residuals) const {
    term.Residual(MotionBetween(ref->PoseAt(x_ref), cur->PoseAt(x_cur)),
                  residuals);
    return true;
  }

  RelativePoseErrorTerm term;
  const LinearizationPoint* ref;
  const LinearizationPoint* cur;
};

// An EdgeBlock by automatic differentiation.
inline std::unique_ptr<ceres::CostFunction> MakeEdgeOracle(
    const RelativePoseErrorTerm& term, const LinearizationPoint* ref,
    const LinearizationPoint* cur) {
  return std::make_unique<ceres::AutoDiffCostFunction<EdgeFunctor, 6, 6, 6>>(
      new EdgeFunctor{term, ref, cur});
}

}  // namespace rgbd_pose
