#pragma once

#include <Eigen/Core>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The direction of gravity, measured in the axes of the body (an accelerometer
// at rest, the normal of a floor), or any other direction that is known in the
// world, such as magnetic north:
//
//   r = (R^T g - m) / sigma
//
// These are three rows of rank 2. Their length is 2 sin(angle / 2) / sigma,
// which increases up to the opposite direction. So there is no false minimum
// there, unlike with the two coordinates of R^T g across m, which are 0 at
// both; only a start at exactly the opposite direction stays.
struct GravityFactor {
  static constexpr char kName[] = "gravity";
  using Blocks = BlockList<PoseBlock>;
  static constexpr int kRows = 3;

  Eigen::Vector3d in_body;   // m, of length 1, as measured
  Eigen::Vector3d in_world;  // g, of length 1
  double sigma = 0.01;       // of the measured direction, rad

  template <typename T>
  bool Residual(const PoseOf<T>& pose, T* r) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = (pose.q.conjugate() * in_world.template cast<T>() -
                in_body.template cast<T>()) /
               T(sigma);
    return true;
  }

  bool Jacobian(const PoseOf<double>& pose, double* r,
                TangentJacobian<kRows, PoseBlock>* by_pose) const {
    Residual(pose, r);
    by_pose->leftCols<3>() = CrossMatrix(pose.q.conjugate() * in_world) / sigma;
    by_pose->rightCols<3>().setZero();
    return true;
  }

  static GravityFactor Sample(FactorSampler* random) {
    return {random->Motion().rotation * Eigen::Vector3d::UnitZ(),
            random->Motion().rotation * Eigen::Vector3d::UnitZ(),
            random->Uniform(0.01, 0.1)};
  }
};

}  // namespace rgbd_pose
