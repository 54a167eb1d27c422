#pragma once

#include <Eigen/Core>
#include <array>

#include "core/factors/blocks.h"
#include "core/factors/motion_between.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// One match under a residual type of costs/matches, over the poses of both
// frames (world_from_cam). PairFactor has all of them in one block.
template <typename Type>
struct MatchFactor {
  static constexpr const char* kName = Type::kName;
  using Blocks = BlockList<PoseBlock, PoseBlock>;
  static constexpr int kRows = Type::kRows;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  std::array<double, Type::kColumns> columns;  // as packed by Type

  template <typename T>
  bool Residual(const PoseOf<T>& ref, const PoseOf<T>& cur, T* r) const {
    Type::Residual(MotionBetween(ref, cur), columns.data(), r);
    return true;
  }

  bool Jacobian(const PoseOf<double>& ref, const PoseOf<double>& cur, double* r,
                ByPose* by_ref, ByPose* by_cur) const {
    const RotationAndCenter<double> motion = MotionBetween(ref, cur);
    double by[kRows][6];
    Type::Jacobian(WithDerivatives(motion), columns.data(), r, by);
    const Eigen::Map<const Eigen::Matrix<double, 6, kRows>> transposed(by[0]);
    const MotionJacobians poses(ref, motion);
    *by_ref = transposed.transpose() * poses.by_ref;
    *by_cur = transposed.transpose() * poses.by_cur;
    return true;
  }
};

}  // namespace rgbd_pose
