#pragma once

#include <Eigen/Core>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A measured position of a point of the body, such as an antenna or a prism,
//
//   r = S (p + R l - x).
struct AbsolutePositionFactor {
  static constexpr char kName[] = "absolute_position";
  using Blocks = BlockList<PoseBlock>;
  static constexpr int kRows = 3;

  Eigen::Vector3d in_world;  // x, m, as measured

  // S, with S^T S the inverse of the covariance of x (m^2).
  Eigen::Matrix3d sqrt_information;

  Eigen::Vector3d in_body = Eigen::Vector3d::Zero();  // l, m

  template <typename T>
  bool Residual(const PoseOf<T>& pose, T* r) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = sqrt_information.template cast<T>() *
               (pose.p + pose.q * in_body.template cast<T>() -
                in_world.template cast<T>());
    return true;
  }

  bool Jacobian(const PoseOf<double>& pose, double* r,
                TangentJacobian<kRows, PoseBlock>* by_pose) const {
    Residual(pose, r);
    by_pose->leftCols<3>() =
        -sqrt_information * (pose.R() * CrossMatrix(in_body));
    by_pose->rightCols<3>() = sqrt_information;
    return true;
  }

  static AbsolutePositionFactor Sample(FactorSampler* random) {
    return {random->Vector<3>(2.0), random->SqrtInformation<3>(),
            random->Vector<3>(1.0)};
  }
};

}  // namespace rgbd_pose
