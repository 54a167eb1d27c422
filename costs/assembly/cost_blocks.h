#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <cmath>

#include "core/estimation/motion_cost.h"
#include "core/geometry/motion.h"
#include "costs/assembly/compressed_block.h"

namespace rgbd_pose {

// One match as a Ceres cost function with its hand-written Jacobian. What does
// not depend on the match is computed once per motion, half the benefit of a
// hand-written Jacobian; so a problem may use only one thread.
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
struct OracleFunctor {
  // flatten: a translation unit with many costs exhausts the compiler's
  // inlining budget, and the oracle would be three times slower than necessary.
  template <typename T>
  [[gnu::flatten]] bool operator()(const T* x, T* residuals) const {
    Residual::Residual(origin.PoseAt(x), columns, residuals);
    return true;
  }

  const LinearizationPoint& origin;
  const double* columns;
};

template <typename Residual>
using OracleBlock =
    ceres::AutoDiffCostFunction<OracleFunctor<Residual>, Residual::kRows, 6>;

// The sums of a MotionCost for its compressed block. Ceres asks for the cost of
// a trial step and, once it has accepted it, for the derivatives: the sums of
// the last x are kept. Only x may change meanwhile (see MotionCost::AddTo).
class MotionSums {
 public:
  // All must outlive this object; a null loss is least squares.
  MotionSums(const MotionCost* cost, const LinearizationPoint* origin,
             const ceres::LossFunction* loss)
      : cost_(cost), origin_(origin), loss_(loss) {}

  bool operator()(const double* x, bool /*with_derivatives*/,
                  CompressedSums<6>* sums) const {
    const Eigen::Map<const MotionVector> at(x);
    if (at != kept_x_) {
      NormalEquations sum;
      cost_->Linearise(origin_->DerivativesAt(x), loss_, &sum);
      kept_ = {sum.hessian, sum.gradient, sum.cost};
      kept_x_ = at;
    }
    *sums = kept_;
    // Checked even if only the cost is needed: a loss may treat a non-finite
    // residual as an outlier with a finite cost.
    return sums->gradient.allFinite() && sums->hessian.allFinite();
  }

 private:
  const MotionCost* cost_;
  const LinearizationPoint* origin_;
  const ceres::LossFunction* loss_;
  mutable MotionVector kept_x_ = MotionVector::Constant(NAN);
  mutable CompressedSums<6> kept_;
};

// A whole MotionCost as one Ceres block of 7 rows.
using MotionBlock = CompressedBlock<6, MotionSums>;

}  // namespace rgbd_pose
