#pragma once

#include <ceres/autodiff_cost_function.h>

#include <memory>

#include "core/pose_graph/graph_problem.h"

namespace rgbd_pose {

struct EdgeFunctor {
  template <typename T>
  bool operator()(const T* x_ref, const T* x_cur, T* residuals) const {
    const RotationAndCenter<T> from = ref->PoseAt(x_ref);
    const RotationAndCenter<T> to = cur->PoseAt(x_cur);
    const Eigen::Matrix<T, 3, 1> shift = to.C - from.C;
    const RotationAndCenter<T> motion = {to.R * from.R.transpose(),
                                         from.R * shift};
    Residual(motion, residuals);
    return true;
  }

  // For any scalar type, with errors below a half turn.
  template <typename T>
  void Residual(const RotationAndCenter<T>& motion, T* r) const {
    using std::sqrt;
    const Eigen::Matrix<T, 3, 3> E = motion.R * term.measured.R.transpose();
    // 4 w = 2 sqrt(1 + trace), vee(E - E^T) = 4 w vec q.
    const T half = sqrt(T(1.0) + E.trace());
    Eigen::Matrix<T, 6, 1> e;
    e << (E(2, 1) - E(1, 2)) / half, (E(0, 2) - E(2, 0)) / half,
        (E(1, 0) - E(0, 1)) / half, motion.C[0] - term.measured.C[0],
        motion.C[1] - term.measured.C[1], motion.C[2] - term.measured.C[2];
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(r);
    out.setZero();
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 6; ++k) out[i] += term.root(i, k) * e[k];
    }
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
