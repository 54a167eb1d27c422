#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "core/geometry/motion.h"

namespace rgbd_pose {

// One match as a Ceres cost function with its hand-written Jacobian. What does
// not depend on the match is computed once per motion, which is half of the
// point of a Jacobian by hand; so one problem serves one thread.
template <typename Residual>
class AnalyticBlock final
    : public ceres::SizedCostFunction<Residual::kRows, 6> {
 public:
  // columns[kColumns] and the origin must outlive the block.
  AnalyticBlock(const LinearizationPoint& origin, const double* columns)
      : origin_(origin), columns_(columns) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      Residual::Residual(origin_.PoseAt(parameters[0]), columns_, residuals);
      return true;
    }
    Residual::Jacobian(origin_.CachedDerivativesAt(parameters[0]), columns_,
                       residuals, reinterpret_cast<double(*)[6]>(jacobians[0]));
    return true;
  }

 private:
  const LinearizationPoint& origin_;
  const double* columns_;
};

// The same residual for ceres::AutoDiffCostFunction: the oracle.
template <typename Residual>
class OracleFunctor {
 public:
  OracleFunctor(const LinearizationPoint& origin, const double* columns)
      : origin_(origin), columns_(columns) {}

  // flatten: a translation unit of many costs exhausts the compiler's budget
  // for inlining, and the oracle would be three times slower than it can be.
  template <typename T>
  [[gnu::flatten]] bool operator()(const T* x, T* residuals) const {
    Residual::Residual(origin_.PoseAt(x), columns_, residuals);
    return true;
  }

 private:
  const LinearizationPoint& origin_;
  const double* columns_;
};

template <typename Residual>
using OracleBlock =
    ceres::AutoDiffCostFunction<OracleFunctor<Residual>, Residual::kRows, 6>;

}  // namespace rgbd_pose
