#pragma once

#include <ceres/loss_function.h>

#include <limits>

#include "core/estimation/motion_cost.h"
#include "costs/assembly/compressed_block.h"

namespace rgbd_pose {

// The sums of a MotionCost, as its compressed block asks for them. Ceres asks
// for the cost of a trial step first and for its derivatives once it has
// accepted it: the sums of the last x are kept, so both take one evaluation.
// Nothing but x changes while the block lives (see MotionCost::AddTo).
class MotionSums {
 public:
  // All must outlive this; a null loss is least squares.
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
    // Also where only the cost is asked for: a loss may take a residual that is
    // not finite for an outlier, with a cost that is.
    return sums->gradient.allFinite() && sums->hessian.allFinite();
  }

 private:
  const MotionCost* cost_;
  const LinearizationPoint* origin_;
  const ceres::LossFunction* loss_;
  mutable MotionVector kept_x_ =
      MotionVector::Constant(std::numeric_limits<double>::quiet_NaN());
  mutable CompressedSums<6> kept_;
};

// A whole MotionCost as one Ceres block of 7 rows.
using MotionBlock = CompressedBlock<6, MotionSums>;

// Compiled once, in cost_factory.cc: Eigen's factorisations take seconds.
extern template bool FactorSums<6>(const CompressedSums<6>& sums,
                                   double* residuals, double* jacobian);

}  // namespace rgbd_pose
