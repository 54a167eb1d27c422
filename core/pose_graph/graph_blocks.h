#pragma once

// What a graph of poses hands to Ceres: residual blocks in the parameters of
// two poses (core/pose_graph/pose_pair.h).

#include <ceres/sized_cost_function.h>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/pose_pair.h"

namespace rgbd_pose {

// S with S^T S = information, a positive semi-definite matrix; nothing (all
// NaN) if it is invalid.
MotionMatrix SqrtInformation(const MotionMatrix& information);

// A measured motion between two poses as six rows,
//
//   r = S [ 2 vec q ; C - C_m ],   q the quaternion of R R_m^T,  q_w >= 0,
//
// S^T S = covariance^-1. 2 vec q is the rotation Exp(omega) = R R_m^T to first
// order, and grows up to a half turn, where omega does.
struct RelativePoseErrorTerm {
  RotationAndCenter<double> measured;
  MotionMatrix root;  // S

  static RelativePoseErrorTerm Of(const Rigid3d& cur_from_ref,
                                  const MotionMatrix& root);

  // r and, unless null, d r / d[x_ref x_cur].
  MotionVector ResidualAt(const RelativeMotion& pair,
                          PosePairJacobian* jacobian) const;
};

// An edge with its hand-written Jacobian. The origins must outlive it.
class EdgeBlock final : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  EdgeBlock(const RelativePoseErrorTerm& term, const LinearizationPoint* ref,
            const LinearizationPoint* cur)
      : term_(term), ref_(ref), cur_(cur) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const RelativePoseErrorTerm term_;
  const LinearizationPoint* const ref_;
  const LinearizationPoint* const cur_;
};

}  // namespace rgbd_pose
