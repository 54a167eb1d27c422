#pragma once

#include <Eigen/Core>

#include "core/factors/blocks.h"
#include "core/factors/moving_pose.h"
#include "core/geometry/motion.h"
#include "costs/factors/match.h"

namespace rgbd_pose {

// One match of two frames with a rolling shutter, over the poses of both frames
// at their stamps (world_from_cam) and their velocities there: the residual of
// a type of costs/matches between the poses at which both rows were exposed,
//
//   r = Residual(PoseAfter(ref, twist_ref, t_ref),
//                PoseAfter(cur, twist_cur, t_cur))
//
// Observations are packed as they are seen, not moved to the stamps. Matches of
// two frames alone do not tell velocities from the motion:
// ConstantVelocityFactor between the same blocks does.
template <typename Type>
struct ShutterMatchFactor {
  static constexpr const char* kName = Type::kName;
  using Blocks = BlockList<PoseBlock, TwistBlock, PoseBlock, TwistBlock>;
  static constexpr int kRows = Type::kRows;
  using ByPose = TangentJacobian<kRows, PoseBlock>;
  using ByTwist = TangentJacobian<kRows, TwistBlock>;

  MatchFactor<Type> match;  // its residual between two poses

  // When the rows of the match were exposed, after the stamps of their frames
  // (Shutter::RowTime), s.
  double ref_seconds = 0.0;
  double cur_seconds = 0.0;

  template <typename T>
  bool Residual(const PoseOf<T>& ref, const Eigen::Matrix<T, 6, 1>& twist_ref,
                const PoseOf<T>& cur, const Eigen::Matrix<T, 6, 1>& twist_cur,
                T* r) const {
    return match.Residual(PoseAfter(ref, twist_ref, ref_seconds),
                          PoseAfter(cur, twist_cur, cur_seconds), r);
  }

  bool Jacobian(const PoseOf<double>& ref, const MotionVector& twist_ref,
                const PoseOf<double>& cur, const MotionVector& twist_cur,
                double* r, ByPose* by_ref, ByTwist* by_twist_ref,
                ByPose* by_cur, ByTwist* by_twist_cur) const {
    ByPose by_ref_row, by_cur_row;
    if (!match.Jacobian(PoseAfter(ref, twist_ref, ref_seconds),
                        PoseAfter(cur, twist_cur, cur_seconds), r, &by_ref_row,
                        &by_cur_row)) {
      return false;
    }
    const PoseAfterJacobians ref_row(ref, twist_ref, ref_seconds),
        cur_row(cur, twist_cur, cur_seconds);
    *by_ref = by_ref_row * ref_row.by_pose;
    *by_twist_ref = by_ref_row * ref_row.by_twist;
    *by_cur = by_cur_row * cur_row.by_pose;
    *by_twist_cur = by_cur_row * cur_row.by_twist;
    return true;
  }
};

}  // namespace rgbd_pose
