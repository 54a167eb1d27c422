#include "core/factors/common_direction.h"

namespace rgbd_pose {

bool CommonDirectionFactor::Jacobian(const PoseOf<double>& a,
                                     const PoseOf<double>& b, double* r,
                                     ByPose* by_a, ByPose* by_b) const {
  Residual(a, b, r);
  const Eigen::Quaterniond a_from_b = a.q.conjugate() * b.q;
  by_a->leftCols<3>() = CrossMatrix(a_from_b * in_b) / sigma;
  by_b->leftCols<3>() =
      -(a_from_b.toRotationMatrix() * CrossMatrix(in_b)) / sigma;
  by_a->rightCols<3>().setZero();
  by_b->rightCols<3>().setZero();
  return true;
}

CommonDirectionFactor CommonDirectionFactor::Sample(FactorSampler* random) {
  return {random->Motion().rotation * Eigen::Vector3d::UnitZ(),
          random->Motion().rotation * Eigen::Vector3d::UnitZ(),
          random->Uniform(0.01, 0.1)};
}

}  // namespace rgbd_pose
